#pragma once

#include <nlohmann/json_fwd.hpp>

#include "planning/space/configuration_space.hpp"

namespace clearway {

/// What a planner in another process is told of a space (YOUR_PLANNER.md): the robot with its limits, links
/// and bodies, and for the policy of each part the voxels that block it, or those that do not.
nlohmann::ordered_json planner_world(const ConfigurationSpace& space);

}  // namespace clearway
