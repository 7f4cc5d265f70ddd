#pragma once

#include "mapping/field/blocked_space.hpp"
#include "planning/routes/painted_route.hpp"

namespace clearway {

/// The cheapest way of a sphere through what is not blocked, by A* on a cubic grid with 26 neighbours from
/// `from` to `to` (map frame); `price(point)` is what a metre costs there. Only cells within `bounds` (where
/// the hand can get) are entered. The empty route when there is none, or when it is out of time.
/// @param radius metres, of the sphere: clearance that every cell of the way has (ends excepted).
/// @param cell   metres, of the grid, > 0; made larger when the bounds would hold more than 4 million cells.
EndEffectorRoute free_route(
    const BlockedSpace& space, const Eigen::AlignedBox3d& bounds, const Eigen::Vector3d& from,
    const Eigen::Vector3d& to, double radius, double cell, const RoutePrice& price,
    const std::function<bool()>& out_of_time = [] { return false; });

}  // namespace clearway
