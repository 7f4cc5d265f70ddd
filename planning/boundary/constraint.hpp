#pragma once

#include "planning/constraint/local_step.hpp"
#include "planning/problem/planner.hpp"

namespace clearway {

/// The constraint method alone (Lahouar et al. 2006, eq. 1-9): local steps until the goal or the first
/// deadlock. A local method: incomplete, and here to show what boundary following adds.
class Constraint : public Planner {
 public:
  using Options = ConstraintOptions;
  static constexpr std::string_view table_name = "constraint";

  /// @throws std::invalid_argument naming the option that is out of range.
  explicit Constraint(const ConstraintOptions& options = {});
  PlanResult plan(const PlanProblem& problem) const override;

 private:
  ConstraintOptions options_;
};

}  // namespace clearway
