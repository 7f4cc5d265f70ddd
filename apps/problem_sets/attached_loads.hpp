#pragma once

#include <string>
#include <vector>

#include "apps/problem_sets/problem_set.hpp"
#include "planning/robot/kinematics.hpp"
#include "planning/robot/load.hpp"

namespace clearway {

/// What a robot of a problem set has in the hand: a load for each piece, which rides on all legs.
struct AttachedLoads {
  std::vector<LegLoad> loads;
  std::vector<std::string> left_out;  ///< bodies without shapes, or in a frame that is none
};

/// The world's objects that links may touch, as bodies that ride on `root`, which never moves.
std::vector<ForeignAttached> standing_bodies(const ForeignWorld& world, const std::string& root);

/// Of a body's weight each piece has the same part.
/// @param start of the robot: where frames of links are
/// @throws std::invalid_argument for a link that the robot does not have, naming the nearest one, and for a
/// mesh of more than 50,000 points or 20,000 corners of its hull
AttachedLoads loads_of(const std::vector<ForeignAttached>& attached, const Robot& robot,
                       const Configuration& start);

}  // namespace clearway
