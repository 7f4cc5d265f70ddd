#include "apps/problem_sets/problem_set.hpp"

#include <cmath>
#include <numbers>
#include <stdexcept>

#include "mapping/system/number_text.hpp"

namespace clearway {

Shape cone_shape(double radius, double height) {
  if (!(radius > 0.0) || !(height > 0.0)) throw std::invalid_argument("a cone has no size");
  constexpr int sides = 64;
  const double about = radius / std::cos(std::numbers::pi / sides);
  std::vector<Eigen::Vector3d> corners{{0.0, 0.0, 0.5 * height}};
  for (int i = 0; i < sides; ++i) {
    const double angle = 2.0 * std::numbers::pi * i / sides;
    corners.emplace_back(about * std::cos(angle), about * std::sin(angle), -0.5 * height);
  }
  return Shape::convex(std::move(corners));
}

std::vector<Eigen::Vector3d> plane_triangles(const Eigen::Vector4d& plane, const Eigen::Vector3d& center,
                                             double reach) {
  const double length = plane.head<3>().norm();
  std::vector<Eigen::Vector3d> corners;
  if (!(length > 1e-9)) return corners;
  constexpr double below = 1e-6, tile = 0.25;  // m; small, as all voxels about a triangle are looked at
  const Eigen::Vector3d normal = plane.head<3>() / length, along = normal.unitOrthogonal();
  const Eigen::Vector3d across = normal.cross(along);
  const Eigen::Vector3d nearest = center - (normal.dot(center) + plane[3] / length + below) * normal;
  const int half = static_cast<int>(std::ceil(reach / tile));
  const auto at = [&](int i, int k) -> Eigen::Vector3d { return nearest + tile * (i * along + k * across); };
  for (int i = -half; i < half; ++i)
    for (int k = -half; k < half; ++k)
      for (const auto& corner :
           {at(i, k), at(i + 1, k), at(i + 1, k + 1), at(i, k), at(i + 1, k + 1), at(i, k + 1)})
        corners.push_back(corner);
  return corners;
}

std::string unit_fault(const Eigen::Vector4d& quaternion, const std::string& order) {
  constexpr double rounded = 0.01;  // of files with few digits
  const double norm = quaternion.norm();
  if (std::abs(norm - 1.0) <= rounded) return {};
  return "a unit quaternion " + order + ", got one of norm " + short_text(norm);
}

Eigen::Isometry3d pose_of_quaternion(const Eigen::Vector3d& position, const Eigen::Vector4d& xyzw) {
  Eigen::Isometry3d pose = Eigen::Isometry3d::Identity();
  pose.translation() = position;
  if (xyzw.isZero(0.0)) return pose;
  if (const std::string fault = unit_fault(xyzw, "x, y, z, w"); !fault.empty())
    throw std::invalid_argument("expected " + fault);
  pose.linear() = Eigen::Quaterniond(xyzw[3], xyzw[0], xyzw[1], xyzw[2]).normalized().toRotationMatrix();
  return pose;
}

}  // namespace clearway
