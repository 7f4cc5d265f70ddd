#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <vector>

#include "planning/problem/planner.hpp"

namespace clearway {

struct RoundingOptions {
  double longest = 0.4;  ///< weighted units (rad): of an edge's end that a corner may take, and half
                         ///< of the edge at most
  double turn = 0.15;    ///< rad, in weighted joint space: at most between two edges of a rounded corner (but
                         ///< for arcs cut into 64 edges, which do not keep it: corners sharper than 2.7 rad)
  double least_clearance = 0.0;  ///< m: an arc comes no nearer at its points, or no nearer than its corner
  int halvings = 5;              ///< of a corner that is not free, before it stays
};

/// A path with the same ends whose corners are replaced by quadratic Bezier arcs, in weighted joint space,
/// as wide as certified edges and the clearance allow; a corner without a free arc stays. All edges of the
/// result are certified free, those of `path` taken for granted. Points nearer than 1e-9 to the one before
/// are left out where the edge without them is certified, too. Stops early when out of time.
/// @param edges_checked is raised by the edges asked for.
std::vector<Configuration> rounded_corners(const PlanProblem& problem, const std::vector<Configuration>& path,
                                           const Eigen::VectorXd& weight, const RoundingOptions& options,
                                           std::uint64_t& edges_checked);

/// The largest angle between an edge and the next, rad in weighted joint space; 0 for fewer than two edges.
double sharpest_turn(const std::vector<Configuration>& path, const Eigen::VectorXd& weight);

}  // namespace clearway
