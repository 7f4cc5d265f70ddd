#pragma once

#include <set>
#include <string>

#include "apps/console/commands.hpp"
#include "datasets/descriptions/setup.hpp"
#include "planning/robot/robot.hpp"

namespace clearway {

/// The robot of a setup as flags would ask for it, with the joints that are planned.
RobotChoice choice_of(const RobotSetup& setup);

/// What is asked of a robot, and where it has the name of the setup's own, also what the setup says
/// of it and nobody asks for: scale, SRDF, group, joints that are fixed, packages and xacro arguments. With
/// another group the setup's fixed joints do not count, which may be those of that group.
RobotChoice with_terms_of(const RobotSetup& setup, RobotChoice asked);

/// The robot of a setup in its place, with the joints that are planned. @throws as choose_robot
Robot planned_robot(const RobotSetup& setup);

/// The same in which these joints move, too, though planning holds them. Its tip stays where it is.
Robot recorded_robot(const RobotSetup& setup, const std::set<std::string>& moving);

}  // namespace clearway
