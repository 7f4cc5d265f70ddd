#pragma once

#include <vector>

#include "planning/check/path_check.hpp"

namespace clearway {

/// Legs of a path, one after the other, on which the robot is the same: it carries the same loads.
struct LegsToCheck {
  Robot robot;
  Snapshot map;
  std::vector<Configuration> waypoints;  ///< the first is where the legs before end
};

/// check_path() of a path on which the robot's loads change: the verdict of all legs, with edges and
/// clearances numbered as if it were one. The legs must follow each other: the edge to a leg that starts
/// elsewhere than where the one before ended is checked with the later one's robot. The first leg that is
/// refused ends the check.
/// @throws as check_path
PathVerdict check_legs(const std::vector<LegsToCheck>& legs, const std::map<std::string, Policy>& policies,
                       double padding, double distance_cap = 0.0, double seen_within = 0.0);

}  // namespace clearway
