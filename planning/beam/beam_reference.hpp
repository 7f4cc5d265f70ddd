#pragma once

#include "planning/beam/beam_lattice.hpp"
#include "planning/problem/planner.hpp"

namespace clearway {

/// Beam search as Fig. 8 of Chong et al. 2008 reads: every head's 3^n neighbours are generated, all of them
/// filtered, the rest sorted and cut to k. Slow; the twin against which Beam is tested.
class BeamReference : public Planner {
 public:
  explicit BeamReference(const PlannerOptions& options)
      : options_(read_beam_options("beam_reference", options, in_force_)) {}
  PlanResult plan(const PlanProblem& problem) const override;
  std::map<std::string, std::string> options() const override { return in_force_; }

 private:
  std::map<std::string, std::string> in_force_;
  BeamOptions options_;
};

}  // namespace clearway
