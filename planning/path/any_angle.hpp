#pragma once

#include <cstdint>
#include <functional>
#include <vector>

#include "planning/problem/planner.hpp"

namespace clearway {

struct AnyAngleOptions {
  int patience = 30;        ///< attempts in a row that may bring nothing
  int attempts = 200;       ///< random cuts and single-joint cuts tried
  double cost_step = 0.05;  ///< weighted length (rad) at which the cost of an edge is sampled
};

/// Cost of a path in joules, eq. 9 of Chong et al. 2008, with every edge cut into pieces no longer than
/// `step` (weighted length): comparable between paths of few long and of many short edges.
double sampled_cost(const PathCost& cost, const std::vector<Configuration>& path,
                    const Eigen::VectorXd& weight, double step);

/// A path with the same ends and no higher sampled cost. First the waypoints that a straight certified edge
/// can jump over are left out, farthest first; then pairs of points, drawn by the problem's seed, are joined
/// in all joints, or in one joint alone (Geraerts and Overmars 2007, partial shortcuts) evenly or without
/// detours, costly joints more often, wherever all changed edges are certified free and the cost falls. Stops
/// early when the problem is out of time. All edges of the result are certified, those of `path` taken for
/// granted.
/// @param edges_checked is raised by the edges asked for.
std::vector<Configuration> straightened(const PlanProblem& problem, std::vector<Configuration> path,
                                        const Eigen::VectorXd& weight, const AnyAngleOptions& options,
                                        std::uint64_t& edges_checked);

}  // namespace clearway
