#pragma once

#include <map>
#include <string>

#include "apps/problem_sets/problem_set.hpp"
#include "planning/robot/kinematics.hpp"

namespace clearway {

/// One value for each joint that a goal names: of those that all its constraints on the joint and the joint's
/// limits allow the nearest to its first position. Files round: what is a thousandth beyond a limit is at it.
/// Joints that are none of the robot's configurations have no limits here.
/// @throws std::invalid_argument "its goal …" when no value is allowed, naming the joint
std::map<std::string, double> allowed_values(const ForeignGoal& goal, const Robot& robot);

/// Refuses a goal of a joint that the robot holds still where the goal does not have it, or a thousandth
/// beside. @throws std::invalid_argument "its goal …", naming the joint and where it stands
void require_held_as_asked(const ForeignGoal& goal, const Robot& robot);

/// Refuses a goal of joint values and a pose of which the values miss the pose, or leave it open as they are
/// not of all joints. @param q nothing where the goal does not name all of the robot's joints
/// @throws std::invalid_argument "its goal …"
void require_pose_as_asked(const ForeignGoal& goal, const Robot& robot, const Configuration& q);

}  // namespace clearway
