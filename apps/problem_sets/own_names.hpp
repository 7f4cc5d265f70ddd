#pragma once

#include <map>
#include <set>
#include <string>

#include "apps/problem_sets/problem_set.hpp"
#include "planning/robot/robot.hpp"

namespace clearway {

/// The problem with the robot's own names of joints and links: a name that the robot does not have stands for
/// the longest one of which it is the longer form with a prefix, as panda_joint1 is of joint1. Where the
/// prefixes of several names begin alike, the shortest is of the robot, and the others are of what it does
/// not have: panda_finger_joint1 beside panda_joint1 stays as it is.
/// @throws std::invalid_argument when two names of a state stand for one joint
ForeignProblem with_names_of(const Robot& robot, const ForeignProblem& problem);

/// Values by the robot's own names of joints; without those for which several names stand.
struct OwnJoints {
  std::map<std::string, double> values;
  std::set<std::string> prefixes;  ///< that the names had
};
OwnJoints own_joints(const Robot& robot, const std::map<std::string, double>& joints);

}  // namespace clearway
