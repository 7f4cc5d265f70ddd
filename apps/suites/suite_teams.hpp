#pragma once

#include <cstddef>
#include <map>
#include <string>

#include "datasets/descriptions/suite.hpp"
#include "mapping/snapshot.hpp"
#include "planning/space/configuration_space.hpp"
#include "planning/team/team.hpp"

namespace clearway {

/// Policies of a robot in that map: `given` is part or "default" -> policy; parts that the robot does not
/// have do not count, and without paint in the map critical parts are like all others.
Policies team_policies(const Robot& robot, const Snapshot& map,
                       const std::map<std::string, std::string>& given);

/// The team of a suite, ready to move. Parts are `not_occupied` where `policies` (part or "default" ->
/// policy) says nothing and the map holds no paint.
/// @throws std::invalid_argument naming team, robot, field and what was expected.
Team make_team(const SuiteTeam& team, const Snapshot& map,
               const std::map<std::string, std::string>& policies);

/// A map of nothing: all is unknown.
Snapshot empty_map();

/// Draws team number `index` of a generator of the kind "crossings": two to five arms (arm5, puma560, panda)
/// that stand in a ring, 0.8 to 1.4 m from their neighbours, and up to three spheres, boxes and cylinders
/// that cross the ring to and fro at 0.05 to 0.4 m/s. Starts and goals are drawn evenly within the joint
/// limits until nothing is nearer than 8 cm to another robot, nor at the start than 30 cm to an obstacle.
/// Deterministic: the same team whatever the generator's count.
SuiteTeam draw_crossing(const SuiteGenerator& generator, std::size_t index);

}  // namespace clearway
