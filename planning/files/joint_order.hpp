#pragma once

#include "planning/files/plan_file.hpp"
#include "planning/robot/robot.hpp"

namespace clearway {

/// The plan in the order of the robot's joints, when it has the same in another order; else as it is.
Plan in_order_of(const Robot& robot, Plan plan);

/// A plan that names no joints has the robot's. @throws std::invalid_argument for one whose joints are
/// others, or stand in another order: its configurations would be taken for other ones
void require_joint_order(const Robot& robot, const Plan& plan);

}  // namespace clearway
