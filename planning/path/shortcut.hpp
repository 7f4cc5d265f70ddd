#pragma once

#include <cstdint>
#include <functional>
#include <vector>

#include "planning/space/configuration_space.hpp"

namespace clearway {

/// A path no longer than `path`, with the same ends: waypoints are left out, then two points of it, drawn by
/// `seed`, and two about each waypoint are joined by straight edges that are certified free, with `attempts`
/// tries at most. Every edge that is not an edge or a part of an edge of `path` has been certified. Lengths
/// are ||weight (q - q')||.
/// @param out_of_time asked before each edge; when it says so, the path as it is by then is returned
std::vector<Configuration> shortcut(
    const ConfigurationSpace& space, std::vector<Configuration> path, const Eigen::VectorXd& weight,
    std::uint64_t seed, int attempts, const std::function<bool()>& out_of_time = [] { return false; });

}  // namespace clearway
