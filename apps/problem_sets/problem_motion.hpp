#pragma once

#include <map>
#include <optional>
#include <set>
#include <string>
#include <vector>

#include "apps/problem_sets/problem_set.hpp"
#include "apps/problem_sets/ready_problem.hpp"
#include "planning/robot_files/load_robot.hpp"
#include "planning/robot_files/srdf_file.hpp"

namespace clearway {

/// A robot with all its joints, of which its settings may hold some.
struct WholeRobot {
  Robot robot;
  std::vector<Joint> held;  ///< those that its settings hold
  std::optional<Srdf> srdf;
};

/// @param request of which `group`, `fixed` and `fixed_states` do not count @throws as load_robot, read_srdf
WholeRobot load_whole_robot(RobotRequest request);

/// What a problem moves: the group that the user names; else the problem's, where the robot's SRDF has it;
/// else the joints that the first goal names, or that move the link that it places. The other joints stand
/// where the user fixes them, by value or by a state; else where the start has them, whatever the robot's
/// settings say; and without a group those that it leaves out at 0 or at the limit nearest to it.
/// @throws std::invalid_argument for a state that the robot does not have, or that has a joint at two values,
/// and naming the problem where the start has a joint that is not planned beyond its limits
ExperimentMotion motion_of(const ForeignProblem& problem, const WholeRobot& known,
                           const RobotRequest& request);

/// What the robot cannot take of where a start has joints, by reason: those that it does not have, that its
/// file fixes elsewhere, and that follow another joint elsewhere.
std::map<std::string, std::set<std::string>> lost_joints(const ForeignProblem& problem, const Robot& whole);

}  // namespace clearway
