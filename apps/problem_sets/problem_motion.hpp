#pragma once

#include <optional>

#include "apps/problem_sets/problem_set.hpp"
#include "apps/problem_sets/ready_problem.hpp"
#include "planning/robot_files/load_robot.hpp"
#include "planning/robot_files/srdf_file.hpp"

namespace clearway {

/// What a problem moves: the group that the user names; else the problem's, where the robot's SRDF has it;
/// else the joints that the first goal names, or that move the link that it places. The other joints stand
/// where the start has them, and without a group those that it leaves out at 0 or at the limit nearest to it.
/// @param whole the robot with all its joints   @param srdf its SRDF, if it has one
ExperimentMotion motion_of(const ForeignProblem& problem, const Robot& whole, const std::optional<Srdf>& srdf,
                           const RobotRequest& request);

}  // namespace clearway
