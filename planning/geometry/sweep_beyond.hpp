#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>

#include "planning/geometry/shape.hpp"

namespace clearway {

/// Whether the hull of the body at two poses is proved to be farther than `margin` from a voxel cube: as
/// swept_distance_to_cube would find, sooner.
/// @param towards a direction from the hull to the cube, the better the sooner; need not be unit.
bool is_sweep_beyond(const Shape& a, const Eigen::Isometry3d& begin, const Eigen::Isometry3d& end,
                     const Eigen::Vector3d& cube_center, double cube_edge, const Eigen::Vector3d& towards,
                     double margin);

}  // namespace clearway
