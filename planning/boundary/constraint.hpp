#pragma once

#include "planning/constraint/local_step.hpp"
#include "planning/problem/planner.hpp"

namespace clearway {

/// The constraint method alone (Lahouar et al. 2006, eq. 1-9): local steps until the goal or the first
/// deadlock. A local method: incomplete, and here to show what boundary following adds.
class Constraint : public Planner {
 public:
  explicit Constraint(const PlannerOptions& options);
  PlanResult plan(const PlanProblem& problem) const override;
  std::map<std::string, std::string> options() const override { return in_force_; }

 private:
  std::map<std::string, std::string> in_force_;
  ConstraintOptions options_;
};

}  // namespace clearway
