#pragma once

#include <Eigen/Core>
#include <Eigen/LU>

namespace clearway {

/// Whether this is a rotation, no mirror and no scale, within `tolerance` for each number.
inline bool is_rotation(const Eigen::Matrix3d& turn, double tolerance = 1e-6) {
  return turn.allFinite() && (turn * turn.transpose()).isIdentity(tolerance) && turn.determinant() > 0.0;
}

}  // namespace clearway
