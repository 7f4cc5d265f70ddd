#pragma once

#include <vector>

#include "planning/boundary/boundary.hpp"
#include "planning/problem/planner.hpp"

namespace clearway {

/// Boundary following tried again, which the paper does not do: the given side, then the other, both first
/// with the given leave_ratio and then with 1. The first path found is the answer; the failure reported is
/// that of the first try.
class BoundarySides : public Planner {
 public:
  using Options = BoundaryOptions;
  static constexpr std::string_view table_name = "boundary_sides";

  /// @throws std::invalid_argument naming the option that is out of range.
  explicit BoundarySides(const BoundaryOptions& options = {});
  PlanResult plan(const PlanProblem& problem) const override;

 private:
  std::vector<Boundary> tries_;
};

}  // namespace clearway
