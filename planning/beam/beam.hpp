#pragma once

#include "planning/beam/beam_options.hpp"
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
  using Options = BeamOptions;
  static constexpr std::string_view table_name = "beam";

  /// @throws std::invalid_argument naming the option that is out of range.
  explicit Beam(const BeamOptions& options = {});
  PlanResult plan(const PlanProblem& problem) const override;

 private:
  BeamOptions options_;
};

}  // namespace clearway
