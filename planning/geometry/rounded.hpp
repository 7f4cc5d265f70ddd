#pragma once

// Not part of the installed library.

#include <Eigen/Core>

#include "planning/geometry/four_points.hpp"

/// What spheres and capsules share: all within a radius of a core.
namespace clearway::rounded {

/// Farthest point, along `direction`, of a sphere about the origin.
inline Eigen::Vector3d support(double radius, const Eigen::Vector3d& direction) {
  const double norm = direction.norm();
  return norm > 0.0 ? Eigen::Vector3d(direction * (radius / norm)) : Eigen::Vector3d(radius, 0.0, 0.0);
}

/// The part of an offset from the core that lies past the radius; zero within it.
inline Eigen::Vector3d offset_to(double radius, const Eigen::Vector3d& offset) {
  const double norm = offset.norm();
  if (!(norm > radius)) return Eigen::Vector3d::Zero();
  return offset * (1.0 - radius / norm);
}

/// Signed distances from all within `radius` of a segment on the z axis.
inline lanes::Numbers signed_distances(double radius, double half_length, const FourPoints& points) {
  const lanes::Numbers beyond =
      lanes::larger(lanes::absolute(points.z) - lanes::all(half_length), lanes::all(0.0));
  return lanes::root(points.x * points.x + points.y * points.y + beyond * beyond) - lanes::all(radius);
}

}  // namespace clearway::rounded
