#pragma once

#include <Eigen/Geometry>
#include <vector>

namespace clearway {

/// x, y, z, roll, pitch, yaw of Rz(yaw) Ry(pitch) Rx(roll): metres, radians. Where the pitch is upright,
/// where roll and yaw are one turn, the roll is 0.
std::vector<double> pose_numbers(const Eigen::Isometry3d& pose);

}  // namespace clearway
