#pragma once

#include "apps/check/check_contract.hpp"

namespace clearway {

/// @param file of the plan
/// @throws std::invalid_argument naming it, when the plan is for other joints than the robot's.
void require_same_joints(const Robot& robot, const Plan& plan, const std::filesystem::path& file);

/// States robot, group and held joints, each with its source; notes gain a sentence for each joint that the
/// plan holds elsewhere than the robot's own files do, and for other xacro arguments.
/// @param robot robot_to_check()
void state_robot(const CheckOptions& options, const Plan& plan, const Robot& robot, Contract& contract);

}  // namespace clearway
