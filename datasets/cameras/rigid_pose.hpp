#pragma once

#include <Eigen/Geometry>
#include <optional>

namespace clearway {

/// The transform that a matrix is, within what single precision leaves of a rotation, and inverting of the
/// last row; nothing: it is not rigid, or not finite.
std::optional<Eigen::Isometry3d> rigid_pose(const Eigen::Matrix4d& matrix);

/// The pose of the axes x forward, y left, z up in the optical ones: z forward, x right, y down.
Eigen::Isometry3d optical_from_sensor();

}  // namespace clearway
