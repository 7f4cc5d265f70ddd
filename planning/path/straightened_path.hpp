#pragma once

// Not part of the installed library.

#include <vector>

#include "planning/space/configuration_space.hpp"

namespace clearway {

/// Where no joint of `q` is farther from than from other places of the edge, about: the nearest place.
Configuration nearest_on(const Configuration& from, const Configuration& to, const Configuration& q);

/// The path without waypoints at the place of the one before. @pre path is not empty
std::vector<Configuration> without_doubles(const std::vector<Configuration>& path);

/// The path without waypoints that a certified edge passes within `tolerance` (rad or m) of every joint.
/// @pre path is not empty, its edges are certified
std::vector<Configuration> straightened(const ConfigurationSpace& space,
                                        const std::vector<Configuration>& path, double tolerance);

}  // namespace clearway
