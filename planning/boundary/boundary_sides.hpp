#pragma once

#include <vector>

#include "planning/boundary/boundary.hpp"
#include "planning/problem/planner.hpp"

namespace clearway {

/// Boundary following tried again, which the paper does not do: the given side, then the other, both first
/// with the given leave_ratio and then with 1. The first path found is the answer; the failure told is that
/// of the first try.
class BoundarySides : public Planner {
 public:
  explicit BoundarySides(const PlannerOptions& options);
  PlanResult plan(const PlanProblem& problem) const override;
  std::map<std::string, std::string> options() const override { return tries_.front().options(); }

 private:
  std::vector<Boundary> tries_;
};

}  // namespace clearway
