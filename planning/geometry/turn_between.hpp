#pragma once

#include <Eigen/Geometry>
#include <cmath>

namespace clearway {

/// A rotation that takes one unit vector to another, within rounding also where they are almost opposite:
/// there Eigen's FromTwoVectors is off by up to a thousandth, and no rotation. (It brings a singular value
/// decomposition as well, which takes the compiler ten seconds.)
inline Eigen::Quaterniond turn_between(const Eigen::Vector3d& from, const Eigen::Vector3d& to) {
  const Eigen::Vector3d a = from.normalized(), b = to.normalized();
  if (a.dot(b) < 0.0) {
    const Eigen::Vector3d across = a.unitOrthogonal();  // half a turn about it first
    return turn_between(-a, b) * Eigen::Quaterniond(0.0, across.x(), across.y(), across.z());
  }
  const Eigen::Vector3d axis = a.cross(b);
  const double twice_cosine = std::sqrt(2.0 * (1.0 + a.dot(b)));  // of half the angle
  const Eigen::Vector3d turn = axis * (1.0 / twice_cosine);
  return Eigen::Quaterniond(0.5 * twice_cosine, turn.x(), turn.y(), turn.z());
}

}  // namespace clearway
