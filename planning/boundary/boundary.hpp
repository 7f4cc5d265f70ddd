#pragma once

#include "planning/constraint/local_step.hpp"
#include "planning/problem/planner.hpp"

namespace clearway {

/// Which way round: towards all upper, or all lower, joint limits.
enum class BoundarySide { upper, lower };

/// When boundary following starts and ends, and which way round; sections of Lahouar 2006.
struct BoundaryOptions {
  ConstraintOptions local = {};
  double enter_ratio = 0.3;  ///< starts when ||dq|| < enter_ratio ||dq_goal|| (section 4), 0 to 0.99; 0: when
                             ///< dq is null
  double leave_ratio = 0.8;  ///< ends when ||q - q_goal|| < leave_ratio d_lock (section 4), 0.01 to 1; 1:
                             ///< section 3.3
  BoundarySide side = BoundarySide::upper;  ///< towards which joint limits, upper or lower
};
BoundaryOptions read_options(OptionReader& reader, BoundaryOptions initial);

/// Constraint method with boundary following, Lahouar et al. 2006, eq. 1-23, in a static scene.
/// Not complete: with more than two joints motion is confined to one plane per deadlock; with two, a
/// leave_ratio below 1 gives up at an obstacle that is small against its distance to the goal.
class Boundary : public Planner {
 public:
  using Options = BoundaryOptions;
  static constexpr std::string_view table_name = "boundary";

  /// @throws std::invalid_argument naming the option that is out of range.
  explicit Boundary(const BoundaryOptions& options = {});
  PlanResult plan(const PlanProblem& problem) const override;

 private:
  BoundaryOptions options_;
};

}  // namespace clearway
