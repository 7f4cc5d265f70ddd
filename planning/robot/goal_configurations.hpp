#pragma once

#include <string>
#include <vector>

#include "planning/robot/kinematics.hpp"
#include "planning/robot/robot.hpp"

namespace clearway {

/// The robot with its tip at the frame of a link. Its inverse kinematics are then numeric, as geometric ones
/// are made for the tip of the robot's settings. @throws std::invalid_argument for a link that it does not
/// have, naming the nearest one, or one that no joint moves.
Robot with_tip(const Robot& robot, const std::string& link);

/// Configurations within limits that put the tip at `map_from_tip`: all branches of a PUMA-like arm, else
/// those that damped least squares find from `near` and from `starts` seeded random configurations, each once
/// (differing by more than 1e-3 in some joint), of joints that turn more than once the turn nearest to
/// `near`. Nearest to `near` first, by the largest difference of a joint.
std::vector<Configuration> goal_configurations(const Robot& robot, const Eigen::Isometry3d& map_from_tip,
                                               const Configuration& near, int starts = 64,
                                               std::uint64_t seed = 1);

}  // namespace clearway
