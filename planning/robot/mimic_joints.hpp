#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "planning/robot/robot.hpp"

namespace clearway {

/// A joint of a URDF that follows another one: its link holds multiplier and offset.
struct MimicJoint {
  int link = 0;
  Joint joint;         ///< its own axis and limits
  std::string master;  ///< the joint that it names
};

/// Lets the links of mimic joints follow their masters; a follower of a mimic joint follows that one's
/// master. A master's limits are narrowed so that its followers keep their own, and say by which; where the
/// axes or kinds differ, the follower's link has its own (Link::own_axis, Link::own_kind).
/// @throws std::invalid_argument in one sentence naming `file` and joint, when a master is missing, fixed or
///         follows its follower, or no value of it keeps its follower's limits.
void resolve_mimics(const std::filesystem::path& file, const std::vector<MimicJoint>& mimics, Robot& robot);

}  // namespace clearway
