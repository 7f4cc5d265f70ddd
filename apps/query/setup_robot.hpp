#pragma once

#include <string>
#include <vector>

#include "apps/console/commands.hpp"
#include "datasets/descriptions/setup.hpp"
#include "planning/robot/robot.hpp"

namespace clearway {

/// The robot of a setup as flags would ask for it, with the joints that are planned.
RobotChoice choice_of(const RobotSetup& setup);

/// The robot of a setup in its place, with the joints that are planned. @throws as choose_robot
Robot planned_robot(const RobotSetup& setup);

/// The same with all joints that were recorded, whatever group is planned. @param recorded their names,
/// sorted
Robot recorded_robot(const RobotSetup& setup, const std::vector<std::string>& recorded);

}  // namespace clearway
