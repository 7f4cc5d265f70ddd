#pragma once

#include <vector>

#include "apps/problem_sets/problem_set.hpp"
#include "planning/robot/robot.hpp"

namespace clearway {

/// Foreign files round: what is a thousandth beyond a limit stands at it.
double near_limits(const Joint& joint, double value);

/// The values of a start or goal (`what`, for the sentence) in the robot's order.
/// @throws std::invalid_argument naming the problem where one is missing, or where there are not as many as
/// joints
std::vector<double> ordered_values(const Robot& robot, const ForeignProblem& problem,
                                   const ForeignState& state, const char* what);

/// @param whole the robot with all its joints
/// @throws std::invalid_argument for a goal of a joint or link that the robot does not have
void require_known(const ForeignProblem& problem, const ForeignGoal& goal, const Robot& whole);

/// Takes out of a goal the joints that mimic others (a gripper's second finger): they agree with these, or
/// say where these are. @throws std::invalid_argument when they do not agree
void resolve_followers(const ForeignProblem& problem, const Robot& whole, ForeignGoal& goal);

/// Makes a goal of joint values one of values in the robot's order, within limits. A goal of a pose alone
/// stays. Constraints on joints that turn without end ask for any whole turn, as in MoveIt: of these the one
/// nearest to the start.
/// @param start in the robot's order
/// @throws std::invalid_argument where the values do not keep what the goal asks of a pose or of what stands
/// still
void settle_joints(const ForeignProblem& problem, const Robot& robot, const Configuration& start,
                   ForeignGoal& goal);

}  // namespace clearway
