#include "apps/problem_sets/problem_set.hpp"

#include <cmath>
#include <numbers>
#include <stdexcept>

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

Eigen::Isometry3d pose_of_quaternion(const Eigen::Vector3d& position, const Eigen::Vector4d& xyzw) {
  Eigen::Isometry3d pose = Eigen::Isometry3d::Identity();
  pose.translation() = position;
  if (xyzw.isZero(0.0)) return pose;
  if (std::abs(xyzw.norm() - 1.0) > 0.01)
    throw std::invalid_argument("expected a unit quaternion x, y, z, w");
  pose.linear() = Eigen::Quaterniond(xyzw[3], xyzw[0], xyzw[1], xyzw[2]).normalized().toRotationMatrix();
  return pose;
}

}  // namespace clearway
