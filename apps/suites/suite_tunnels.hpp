#pragma once

#include <cstddef>
#include <vector>

#include "datasets/descriptions/suite.hpp"
#include "planning/space/configuration_space.hpp"

namespace clearway {

/// A painted tube and the query through it.
struct Tunnel {
  SuiteWorld world;                ///< paint alone
  Snapshot map;                    ///< made of it
  std::vector<Configuration> way;  ///< what was painted: start, three to six turns, goal
};

/// Draws tunnel number `index` of a generator: a winding joint-space way of the robot, and one volume painted
/// along the way of its hand (its critical parts, or what is on its tip's link when it has none). The spheres
/// hold the hand with a voxel to spare however it is turned, a third of their radius apart and up to half a
/// voxel off the way, as a human's are.
/// Start and goal are free, every piece of the way is proved free, the straight edge from start to goal is
/// not. Each index is drawn by itself. @param padding metres
/// @throws std::runtime_error when 2,000 draws hold no such tunnel.
Tunnel draw_tunnel(const SuiteGenerator& generator, std::size_t index, const Robot& robot,
                   const Policies& policies, double padding);

}  // namespace clearway
