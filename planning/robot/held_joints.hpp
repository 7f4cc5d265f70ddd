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
/// @param others where joints are that the state leaves out (joints_left_open)
/// @throws std::invalid_argument when the state leaves out a joint, unless `others` is given, a value is out
/// of limits, states of this name of several groups contradict each other, or it has a joint elsewhere than
/// where that is held without anybody having asked for it.
std::optional<Configuration> named_configuration(const Robot& robot, const std::string& state);
std::optional<Configuration> named_configuration(const Robot& robot, const std::string& state,
                                                 const Configuration& others);

/// The same, whatever the state says of joints that are held.
std::optional<Configuration> moving_joints_of(const Robot& robot, const std::string& state,
                                              const Configuration& others);

/// Indices of the joints of which a state of that name says nothing; none where there is no such state.
std::vector<std::size_t> joints_left_open(const Robot& robot, const std::string& state);

}  // namespace clearway
