#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <utility>

#include "planning/space/configuration_space.hpp"
#include "tests/worlds/random_world.hpp"

namespace clearway::evidence {

/// A robot in a map under a policy, all three drawn from a seed: robots that come with the program, some
/// scaled and moved, and arms that nobody has seen; maps of obstacles alone, of paint with holes, of scans,
/// and of paint for critical parts; voxels between 2 and 6 % of the robot's reach; padding or none.
struct DrawnWorld {
  std::string what;  ///< one line: robot, kind of map, voxel, padding
  std::unique_ptr<ConfigurationSpace> space;
};

DrawnWorld draw_world(std::uint64_t seed);

/// The same robots in maps that end where they reach, made of few short looks, every part under
/// `not_occupied`: there a robot leaves the map's bounds before it meets anything.
DrawnWorld draw_world_that_ends(std::uint64_t seed);

/// A free start and a free goal, near or far; nothing when 400 draws gave none.
std::optional<std::pair<Configuration, Configuration>> draw_ends(const ConfigurationSpace& space,
                                                                 Random& random);

}  // namespace clearway::evidence
