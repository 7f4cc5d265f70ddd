#pragma once

#include "apps/problem_sets/problem_set.hpp"
#include "planning/robot/robot.hpp"

namespace clearway {

/// The problem with the robot's own names of joints and links: a name that the robot does not have stands for
/// its only one of which it is the longer form with a prefix, as panda_joint1 is of joint1.
/// @throws std::invalid_argument when two names of a state stand for one joint
ForeignProblem with_names_of(const Robot& robot, const ForeignProblem& problem);

}  // namespace clearway
