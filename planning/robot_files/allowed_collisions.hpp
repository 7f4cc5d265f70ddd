#pragma once

#include <filesystem>
#include <string>
#include <utility>
#include <vector>

#include "planning/robot/robot.hpp"

namespace clearway {

/// Pairs of bodies that never move against each other, or whose links share one joint (links without bodies
/// that are fixed on either side of it are passed over): always exempt. Not what is fixed to such a link: a
/// gripper on the hand's flange and a camera on the link above the last joint can meet.
std::vector<std::pair<int, int>> adjacent_bodies(const Robot& robot);

/// Pairs with one joint between them that are proved to stay apart wherever it stands: no planner or check
/// needs to look at them.
std::vector<std::pair<int, int>> never_meeting_bodies(const Robot& robot);

/// Pairs that touch at the zero configuration (clamped into the limits) and in at least 95 % of 200 seeded
/// random ones: parts of a design that overlaps, not contacts, as MoveIt's setup assistant reasons.
std::vector<std::pair<int, int>> always_colliding_bodies(const Robot& robot);

/// All pairs of bodies of the named parts (or links).
/// @throws std::invalid_argument naming `file` and the part that the robot does not have.
std::vector<std::pair<int, int>> bodies_of_parts(
    const Robot& robot, const std::vector<std::pair<std::string, std::string>>& parts,
    const std::filesystem::path& file);

}  // namespace clearway
