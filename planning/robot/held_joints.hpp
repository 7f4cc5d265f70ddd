#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "planning/robot/kinematics.hpp"
#include "planning/robot/robot.hpp"

namespace clearway {

/// The robot with these joints still: they are no longer part of configurations, and their links (mimic ones
/// too) hang where the values put them. Their bodies stay, and so do masses and exempt pairs: bodies that now
/// stand still against each other are exempt only if they were before. To be called at the robot's full size.
/// @throws std::invalid_argument naming `file`, joint and limits for a joint that is none of the robot's, a
///         value that is not finite or out of limits, or when no joint is left that moves.
Robot with_held_joints(const Robot& robot, const std::vector<HeldJoint>& held,
                       const std::filesystem::path& file);

/// The configuration of a named state, at the robot's scale; empty when there is no state of that name. A
/// value that four digits round beyond a limit is that limit.
/// @throws std::invalid_argument when the state leaves out a joint, or a value is out of limits.
std::optional<Configuration> named_configuration(const Robot& robot, const std::string& state);

}  // namespace clearway
