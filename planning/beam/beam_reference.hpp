#pragma once

#include "planning/beam/beam_options.hpp"
#include "planning/problem/planner.hpp"

namespace clearway {

/// Beam search as Fig. 8 of Chong et al. 2008 reads: every head's 3^n neighbours are generated, all of them
/// filtered, the rest sorted and cut to k. Slow; the twin against which Beam is tested.
class BeamReference : public Planner {
 public:
  using Options = BeamOptions;
  static constexpr std::string_view table_name = "beam_reference";

  /// @throws std::invalid_argument naming the option that is out of range.
  explicit BeamReference(const BeamOptions& options = {});
  PlanResult plan(const PlanProblem& problem) const override;

 private:
  BeamOptions options_;
};

}  // namespace clearway
