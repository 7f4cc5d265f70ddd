#pragma once

#include "planning/beam/beam_lattice.hpp"
#include "planning/problem/planner.hpp"

namespace clearway {

/// Beam search, Chong et al. 2008, Fig. 8 and eq. 4-11, with the neighbours enumerated in the order of their
/// distance to the goal and checked only until k are kept. Same result as BeamReference, bit for bit.
///
/// Filters: (1) the node and the straight edge from its head must be free (`node_only` asks for the node
/// alone, as the paper does, and promises nothing for edges), (2) joint limits, (3) never a head before,
/// (4) of several heads the one with the cheapest path and a free edge keeps the node.
/// Ties: dist_to_goal, then path cost, then the lattice index in lexicographic order; between parents of
/// equal cost the one that was kept first.
class Beam : public Planner {
 public:
  explicit Beam(const PlannerOptions& options) : options_(read_beam_options("beam", options, in_force_)) {}
  PlanResult plan(const PlanProblem& problem) const override;
  std::map<std::string, std::string> options() const override { return in_force_; }

 private:
  std::map<std::string, std::string> in_force_;
  BeamOptions options_;
};

}  // namespace clearway
