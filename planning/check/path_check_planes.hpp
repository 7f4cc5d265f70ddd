#pragma once

// Private to path_check: separating planes, each proved by the sizes of the bodies on either side, whoever
// proposed it.

#include <Eigen/Core>
#include <Eigen/Geometry>

#include "planning/check/path_check_shape.hpp"

namespace clearway::check {

/// What projecting to and fro between two convex bodies found.
struct Gap {
  double proved = 0.0;  ///< m: between two planes with the bodies on either side; 0 where none was found
  double found = 0.0;   ///< m: between a point of either body; of hulls unknown, infinity
  /// Whether the one bears out the other, but for a nanometre or a ten millionth.
  bool is_closed() const { return found - proved <= 1e-9 + 1e-7 * proved; }
  /// Whether nobody needs to be asked any more.
  bool proves(double enough) const { return proved > 0.0 && (proved > enough || is_closed()); }
};

/// From a placed body to the closed cube of a voxel. Ends early once more than `enough` is proved.
Gap voxel_gap(const ShapeReading& shape, const Eigen::Isometry3d& pose, const Eigen::Vector3d& cube,
              double edge, double enough);

/// Between two placed bodies. Ends early once more than `enough` is proved.
Gap body_gap(const ShapeReading& a, const Eigen::Isometry3d& pose_a, const ShapeReading& b,
             const Eigen::Isometry3d& pose_b, double enough);

}  // namespace clearway::check
