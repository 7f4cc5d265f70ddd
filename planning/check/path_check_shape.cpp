#include "planning/check/path_check_shape.hpp"

#include <algorithm>
#include <cmath>

namespace clearway::check {

ShapeReading::ShapeReading(const Shape& shape) {
  switch (shape.kind()) {
    case Shape::Kind::sphere:
    case Shape::Kind::capsule:
      round = shape.radius();
      half_length = shape.length() / 2;
      break;
    case Shape::Kind::cylinder:
      disc = shape.radius();
      half_length = shape.length() / 2;
      break;
    case Shape::Kind::box:
      core = Core::box;
      high = shape.edges() / 2;
      low = -high;
      break;
    case Shape::Kind::convex: {
      core = Core::hull;
      corners = shape.vertices();
      Eigen::AlignedBox3d box;
      for (const Eigen::Vector3d& v : corners) box.extend(v);
      low = box.min();
      high = box.max();
      break;
    }
  }
}

double ShapeReading::farthest(const Eigen::Isometry3d& pose, const Eigen::Vector3d& n) const {
  const Eigen::Vector3d d = pose.linear().transpose() * n;
  const double middle = n.dot(pose.translation());
  switch (core) {
    case Core::disc: {
      const double across = disc > 0.0 ? disc * std::hypot(d.x(), d.y()) : 0.0;
      return middle + round + across + std::abs(d.z()) * half_length;
    }
    case Core::box:
      return middle + d.cwiseAbs().dot(high);
    case Core::hull:
      break;
  }
  double most = -1e300;
  for (const Eigen::Vector3d& v : corners) most = std::max(most, d.dot(v));
  return middle + most;
}

Eigen::Vector3d ShapeReading::nearest_of_core(const Eigen::Isometry3d& pose,
                                              const Eigen::Vector3d& point) const {
  Eigen::Vector3d p = pose.linear().transpose() * (point - pose.translation());
  if (core != Core::disc) {
    p = p.cwiseMax(low).cwiseMin(high);
  } else {
    const double away = p.head<2>().norm();
    if (away > disc) p.head<2>() *= disc / away;
    p.z() = std::clamp(p.z(), -half_length, half_length);
  }
  return pose.translation() + pose.linear() * p;
}

double farthest(const Shape& shape, const Eigen::Isometry3d& pose, const Eigen::Vector3d& n) {
  return ShapeReading(shape).farthest(pose, n);
}

double extent(const Shape& shape) {
  const ShapeReading reading(shape);
  if (reading.core == ShapeReading::Core::disc) return reading.round + reading.disc + reading.half_length;
  if (reading.core == ShapeReading::Core::box) return reading.high.norm();
  double most = 0.0;
  for (const Eigen::Vector3d& v : reading.corners) most = std::max(most, v.norm());
  return most;
}

}  // namespace clearway::check
