#pragma once

#include <cstddef>
#include <vector>

#include "planning/problem/waypoint_origin.hpp"
#include "planning/space/configuration_space.hpp"

namespace clearway {

/// The origins of a path that was made of `before` by shortcuts and rounded corners: an edge that is an edge
/// of `before`, or a part of one, keeps its origin; any other is `shortened`. None where `origins` are none.
/// @param origins of the waypoints of `before`
std::vector<WaypointOrigin> origins_after(const std::vector<Configuration>& before,
                                          const std::vector<WaypointOrigin>& origins,
                                          const std::vector<Configuration>& after);

/// Of configurations along a path, in its order: the waypoint to which the edge leads that each is nearest
/// to (the first one leads to waypoint 1), 0 for a path of one waypoint. Motions that round the corners of
/// the path take the origin of what they are near. @pre path is not empty
std::vector<std::size_t> waypoints_ahead(const std::vector<Configuration>& path,
                                         const std::vector<Configuration>& along);

}  // namespace clearway
