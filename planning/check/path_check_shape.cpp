#include "planning/check/path_check_shape.hpp"

#include <algorithm>
#include <cmath>

namespace clearway::check {

double farthest(const Shape& shape, const Eigen::Isometry3d& pose, const Eigen::Vector3d& n) {
  const Eigen::Vector3d d = pose.linear().transpose() * n;
  const double middle = n.dot(pose.translation());
  switch (shape.kind()) {
    case Shape::Kind::sphere:
      return middle + shape.radius();
    case Shape::Kind::capsule:
      return middle + shape.radius() + std::abs(d.z()) * shape.length() / 2;
    case Shape::Kind::cylinder:
      return middle + shape.radius() * std::hypot(d.x(), d.y()) + std::abs(d.z()) * shape.length() / 2;
    case Shape::Kind::box:
      return middle + d.cwiseAbs().dot(shape.edges()) / 2;
    case Shape::Kind::convex:
      break;
  }
  double most = -1e300;
  for (const Eigen::Vector3d& v : shape.vertices()) most = std::max(most, d.dot(v));
  return middle + most;
}

double extent(const Shape& shape) {
  switch (shape.kind()) {
    case Shape::Kind::sphere:
    case Shape::Kind::capsule:
    case Shape::Kind::cylinder:
      return shape.radius() + shape.length() / 2;
    case Shape::Kind::box:
      return shape.edges().norm() / 2;
    case Shape::Kind::convex:
      break;
  }
  double most = 0.0;
  for (const Eigen::Vector3d& v : shape.vertices()) most = std::max(most, v.norm());
  return most;
}

}  // namespace clearway::check
