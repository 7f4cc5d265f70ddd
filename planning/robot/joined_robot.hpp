#pragma once

#include <string>
#include <utility>
#include <vector>

#include "planning/robot/kinematics.hpp"

namespace clearway {

/// Several robots as one: its joints are theirs, one robot after the other, its root is the map's frame, and
/// two bodies of different robots may never touch. Links, joints and parts are called `name/link` and so on.
/// What is known of one robot (kinematics, contacts, the independent check of a path, a page) so holds for
/// teams that move together.
/// @throws std::invalid_argument for no robots, or a name given twice, naming it.
Robot joined_robot(const std::vector<std::pair<std::string, Robot>>& robots);

/// The configurations in the order of the joints of joined_robot.
Configuration joined(const std::vector<Configuration>& configurations);

}  // namespace clearway
