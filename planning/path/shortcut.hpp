#pragma once

#include <cstdint>
#include <vector>

#include "planning/space/configuration_space.hpp"

namespace clearway {

/// A path no longer than `path`, with the same ends: `attempts` times two points of it are drawn (by `seed`)
/// and joined by a straight edge when that edge is certified free. Every edge that is not an edge or a part
/// of an edge of `path` has been certified. Lengths are ||weight (q - q')||.
std::vector<Configuration> shortcut(const ConfigurationSpace& space, std::vector<Configuration> path,
                                    const Eigen::VectorXd& weight, std::uint64_t seed, int attempts);

}  // namespace clearway
