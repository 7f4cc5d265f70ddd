#pragma once

#include "mapping/field/blocked_space.hpp"
#include "planning/routes/painted_route.hpp"

namespace clearway {

/// What a metre of a route costs at a point whose BlockedSpace::clearance is `clearance`, >= 1.
using CellPrice = std::function<double(const Eigen::Vector3d& point, double clearance)>;

/// A cheap way of a sphere through what is not blocked, by A* on a cubic grid with 26 neighbours from
/// `from` to `to` (map frame); `price` is what a metre costs there. Only cells within `bounds` (where
/// the hand can get) are entered. The empty route when there is none, or when it is out of time.
/// @param most_times the way costs at most so many times the cheapest, >= 1: with 1 it is the cheapest, with
///                   more it is found sooner (weighted A*, Pohl 1970).
/// @param radius metres, of the sphere: clearance that every cell of the way has (ends excepted).
/// @param cell   metres, of the grid, > 0; made larger when the bounds would hold more than 4 million cells.
EndEffectorRoute free_route(
    const BlockedSpace& space, const Eigen::AlignedBox3d& bounds, const Eigen::Vector3d& from,
    const Eigen::Vector3d& to, double radius, double cell, const CellPrice& price,
    const std::function<bool()>& out_of_time = [] { return false; }, double most_times = 1.0);

}  // namespace clearway
