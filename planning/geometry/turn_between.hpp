#pragma once

#include <Eigen/Geometry>

namespace clearway {

/// A rotation that takes one unit vector to another, within rounding also where they are almost opposite:
/// there Eigen's FromTwoVectors is off by up to a thousandth, and no rotation.
inline Eigen::Quaterniond turn_between(const Eigen::Vector3d& from, const Eigen::Vector3d& to) {
  if (from.dot(to) >= 0.0) return Eigen::Quaterniond::FromTwoVectors(from, to);
  const Eigen::Vector3d across = from.unitOrthogonal();  // half a turn about it first
  return Eigen::Quaterniond::FromTwoVectors(-from, to) *
         Eigen::Quaterniond(0.0, across.x(), across.y(), across.z());
}

}  // namespace clearway
