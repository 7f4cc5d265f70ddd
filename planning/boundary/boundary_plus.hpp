#pragma once

#include "planning/constraint/local_step.hpp"
#include "planning/problem/planner.hpp"

namespace clearway {

/// What boundary_plus may spend on each of its stages.
struct BoundaryPlusOptions {
  ConstraintOptions local = {};  ///< its max_steps stays 0: local_steps and plane_steps count
  double stride = 4.0;  ///< max_step, when left to us, is that many times the one of `constraint`, 0.1 to 10
  int local_steps = 300;        ///< of one run of the local method, 0 to 1,000,000; 0: no local method
  int planes = 4;               ///< tried at most from each side, 0 to 1000; 0: none
  int plane_steps = 60;         ///< of one run along a boundary and local steps after it, 1 to 1,000,000
  int max_samples = 100000000;  ///< of all trees, 0 to 100,000,000; 0: none
  double guided_share = 0.6;    ///< of its samples that follow a route for the hand, after the first 20, 0
                                ///< to 1
  int shortcuts = 100;          ///< attempts to shorten the path, 0 to 1,000,000
  bool smooth = true;           ///< corners are rounded
};
BoundaryPlusOptions read_options(OptionReader& reader, BoundaryPlusOptions initial);

/// Ours, built on the local method and the boundary following of Lahouar et al. 2006: first trees of 2,000
/// samples, which answer most queries in less time than the local method's first steps take; then that method
/// from the start and from the goal; where both are stuck, bypasses in several planes; then a hand-over to
/// trees that grow from all traces, and back to the local method. Every edge of the result is certified. The
/// result's `solved_by` and the explanation name the stage that solved.
class BoundaryPlus : public Planner {
 public:
  using Options = BoundaryPlusOptions;
  static constexpr std::string_view table_name = "boundary_plus";

  /// @throws std::invalid_argument for options out of range or that leave nothing to try.
  explicit BoundaryPlus(const BoundaryPlusOptions& options = {});
  PlanResult plan(const PlanProblem& problem) const override;

 private:
  BoundaryPlusOptions options_;
};

}  // namespace clearway
