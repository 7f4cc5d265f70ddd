#pragma once

#include <map>
#include <optional>
#include <set>
#include <string>

#include "apps/problem_sets/problem_set.hpp"
#include "apps/problem_sets/ready_problem.hpp"
#include "planning/robot_files/load_robot.hpp"
#include "planning/robot_files/srdf_file.hpp"

namespace clearway {

/// What a problem moves: the group that the user names; else the problem's, where the robot's SRDF has it;
/// else the joints that the first goal names, or that move the link that it places. The other joints stand
/// where the user fixes them, by value or by a state; else where the start has them, whatever the robot's
/// settings say; and without a group those that it leaves out at 0 or at the limit nearest to it.
/// @param whole the robot with all its joints   @param srdf its SRDF, if it has one
/// @throws std::invalid_argument for a state that the robot does not have, or that has a joint at two values
ExperimentMotion motion_of(const ForeignProblem& problem, const Robot& whole, const std::optional<Srdf>& srdf,
                           const RobotRequest& request);

/// What the robot cannot take of where a start has joints, by reason: those that it does not have, that its
/// file fixes elsewhere, and that follow another joint elsewhere.
std::map<std::string, std::set<std::string>> lost_joints(const ForeignProblem& problem, const Robot& whole);

}  // namespace clearway
