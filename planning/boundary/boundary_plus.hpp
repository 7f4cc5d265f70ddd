#pragma once

#include "planning/constraint/local_step.hpp"
#include "planning/problem/planner.hpp"

namespace clearway {

/// What boundary_plus may spend on each of its stages.
struct BoundaryPlusOptions {
  ConstraintOptions local;    ///< its max_steps is not used: local_steps and plane_steps are
  double stride = 4.0;        ///< max_step, when left to us, is that many times the one of `constraint`
  int local_steps = 300;      ///< of one run of the local method
  int planes = 4;             ///< tried at most from each side, 0: none
  int plane_steps = 60;       ///< of one run along a boundary, local steps after it included
  int max_samples = 20000;    ///< of the hand-over, 0: none
  double guided_share = 0.3;  ///< of its samples that a route for the hand proposes, after the first 300
  int shortcuts = 100;        ///< attempts to shorten the path
  bool smooth = true;         ///< corners are rounded
};

/// Ours, built on the local method and the boundary following of Lahouar et al. 2006: the local method from
/// the start and from the goal; where both are stuck, bypasses in several planes; then a hand-over to sampled
/// trees that grow from all traces, and back to the local method. Every edge of the result is certified. The
/// statistic `solved_by` (0: the straight edge, 1: local, 2: plane, 3: hand-over) and the explanation tell
/// which stage it took.
class BoundaryPlus : public Planner {
 public:
  /// @throws std::invalid_argument for options out of range or that leave nothing to try.
  explicit BoundaryPlus(const PlannerOptions& options);
  PlanResult plan(const PlanProblem& problem) const override;
  std::map<std::string, std::string> options() const override { return in_force_; }

 private:
  std::map<std::string, std::string> in_force_;
  BoundaryPlusOptions options_;
};

}  // namespace clearway
