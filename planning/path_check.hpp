#pragma once

#include <string>
#include <vector>

#include "mapping/snapshot.hpp"
#include "planning/configuration_space.hpp"

namespace clearway {

/// What the independent check found.
struct PathVerdict {
  bool valid = false;
  bool undecided = false;            ///< neither proved free nor shown to collide at the finest step; not valid
  double min_clearance = 0.0;        ///< certified lower bound over the whole path, metres
  std::string first_contact;         ///< empty when valid: edge, parameter, part, voxel state and place
  int edge = -1;                     ///< of the first contact
  double parameter = 0.0;            ///< along that edge, 0..1
  std::vector<double> clearance;     ///< at each waypoint, metres, capped at `distance_cap`
  std::string checker = "kdl+fcl";   ///< whose kinematics and geometry decided
};

/// Re-checks a path in code that no planner shares: KDL kinematics built from the robot, FCL `collide` and
/// unsigned `distance` (shape against voxel boxes read straight from the tree), its own edge subdivision.
/// Contract as ConfigurationSpace: for EVERY configuration on every straight edge.
PathVerdict check_path(const Robot& robot, const Snapshot& map, const std::map<std::string, Policy>& policies,
                       double padding, const std::vector<Configuration>& waypoints,
                       double distance_cap = 0.2);

}  // namespace clearway
