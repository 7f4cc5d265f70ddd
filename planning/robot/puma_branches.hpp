#pragma once

#include <array>
#include <optional>

#include "planning/robot/kinematics.hpp"

namespace clearway {

/// The eight solutions of a PUMA-like arm without regard to limits; index bits: 4 shoulder, 2 elbow, 1 wrist
/// flipped. All empty when the wrist is out of reach. At the wrist's singularity theta_4 = theta4_hint.
/// @throws std::invalid_argument when the robot does not follow Craig's table.
std::array<std::optional<Configuration>, 8> puma_branches(const Robot& robot,
                                                          const Eigen::Isometry3d& map_from_tip,
                                                          double theta4_hint);

/// Which of the eight `q` itself stands on: the one that its own tip pose leads back to.
std::size_t puma_branch_of(const Robot& robot, const Configuration& q);

/// The same configuration with each joint that whole turns leave where it is turned by these to lie nearest
/// to `near` within its limits; empty when a joint that turns cannot be within them.
std::optional<Configuration> unwrapped_within_limits(const Robot& robot, Configuration q,
                                                     const Configuration& near);

}  // namespace clearway
