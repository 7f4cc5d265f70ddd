#pragma once

// Not part of the installed library.

#include <Eigen/Core>

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

}  // namespace clearway::rounded
