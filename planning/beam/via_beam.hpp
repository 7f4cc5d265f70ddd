#pragma once

#include <cstdint>
#include <vector>

#include "planning/problem/planner.hpp"
#include "planning/routes/end_effector.hpp"
#include "planning/routes/painted_route.hpp"

namespace clearway {

struct ViaBeamOptions {
  int width = 8;         ///< heads kept at each via region
  int children = 6;      ///< configurations tried from each head
  double spacing = 0.0;  ///< between via regions, metres; 0: half of the hand's outer radius
  int effort = 16;       ///< a region that none reached is tried again with up to so many times the children
  int halvings = 1;      ///< of the spacing, when the whole search failed
};

/// What a search through via regions found.
struct ViaPath {
  std::vector<Configuration> waypoints;  ///< from start to goal, every edge certified; empty: none
  std::vector<Configuration> farthest;   ///< the path to the last region that was reached
  std::size_t regions = 0;               ///< via regions of the route
  std::size_t reached = 0;               ///< of these, those that some head reached
  Eigen::Vector3d stopped_at = Eigen::Vector3d::Zero();  ///< middle of the first region that none reached
  std::uint64_t configurations = 0, edges = 0;           ///< checked
};

/// A beam search whose layers are the via regions of a route. Each head, a configuration whose hand is in
/// region i, is moved to region i + 1 in several ways: by the least joint motion, drawn towards the goal
/// configuration by its share of what is left, and with random changes that leave the hand where it is
/// (damped least squares, 3 rows). Children that are free and whose edge from the head is certified are
/// ranked by half the length behind them plus dist_to_goal (Chong 2008, eq. 10); `width` are kept, no two
/// alike where there is a choice. A region that none reaches is tried again with more and wilder children,
/// then all with half the spacing. The last region holds the goal's hand, from where the straight edge to the
/// goal is tried from each head.
ViaPath search_via_regions(const PlanProblem& problem, const EndEffector& hand, const EndEffectorRoute& route,
                           const Eigen::VectorXd& weight, const ViaBeamOptions& options);

}  // namespace clearway
