#pragma once

#include <cstddef>

#include "datasets/descriptions/suite.hpp"
#include "planning/space/configuration_space.hpp"

namespace clearway {

/// A painted volume with a hole, and the query whose straight way the hole blocks.
struct Hole {
  SuiteWorld world;  ///< paint, and one pocket in it
  Snapshot map;      ///< made of it
  Configuration start, goal;
};

/// Draws volume number `index` of a generator, in the manner of scenario 3 of Chong et al. 2008 (Fig. 17).
/// Start: anywhere in the middle four fifths of the joint limits. Goal: 35 to 50 degrees on in the first
/// joint, up to 8 degrees off in the others. With the radius of the hand's sphere as unit: 300 to 800 spheres
/// of 1.25 to 2 are painted along the hand's straight way, up to 2.3 off it along each axis; the pocket has a
/// radius of 0.1 to 0.6 (kind large_holes: 0.6 to 1.5) and lies up to 0.5 off the middle third of the way.
/// A draw is kept when start and goal are free, and the straight edge is free without the pocket and blocked
/// with it: no planner is asked. Whether there is a way round the hole is not known.
/// Each index is drawn by itself. @param padding metres
/// @throws std::runtime_error when 20,000 draws of ends, or 500 of paint, hold none
Hole draw_hole(const SuiteGenerator& generator, std::size_t index, const Robot& robot,
               const Policies& policies, double padding);

}  // namespace clearway
