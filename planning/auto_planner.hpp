#pragma once

#include "planning/problem/planner.hpp"

namespace clearway {

class OptionReader;

/// Options of `auto`.
struct AutoPlannerOptions {
  double prismatic_scale = 0.0;  ///< rad per metre, up to 1e6; 0: see joint_weights
  int max_samples = 100000000;   ///< of the trees of one round, 1 to 100,000,000
  int shortcuts = 100;           ///< tries to shorten the path, 0 to 1,000,000
  int threads = 1;               ///< rounds at the same time, 1 to 64
};
AutoPlannerOptions read_options(OptionReader& reader, AutoPlannerOptions initial);

/// The planner to call when nothing speaks for another one. In turn, each with a budget that is counted, not
/// timed, until one succeeds: `rrtconnect` (the straight edge first) with 10,000 samples; the local method
/// and its planes (`boundary_plus` without trees); `rrtconnect` anew; `beam_guided`; then, with twice as many
/// samples each round, `rrtconnect` and `boundary_plus` until time is out. All of its path is
/// certified. The same seed gives the same path, also with several threads: of the rounds that succeed the
/// first in turn counts, and those after it are called off.
class AutoPlanner : public Planner {
 public:
  using Options = AutoPlannerOptions;
  static constexpr std::string_view table_name = "auto";

  /// @throws std::invalid_argument naming the option that is out of range.
  explicit AutoPlanner(const AutoPlannerOptions& options = {});
  PlanResult plan(const PlanProblem& problem) const override;

 private:
  AutoPlannerOptions options_;
};

}  // namespace clearway
