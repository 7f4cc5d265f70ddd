#pragma once

#include "planning/constraint/local_step.hpp"
#include "planning/problem/planner.hpp"

namespace clearway {

/// When boundary following starts and ends, and which way round.
struct BoundaryOptions {
  ConstraintOptions local;
  double enter_ratio = 0.3;  ///< starts when ||dq|| < enter_ratio ||dq_goal|| (section 4); 0: when dq is null
  double leave_ratio = 0.8;  ///< ends when ||q - q_goal|| < leave_ratio d_lock (section 4); 1: section 3.3
  bool upper = true;         ///< side: towards all upper, or all lower, joint limits
};
BoundaryOptions read_boundary_options(OptionReader& reader);

/// Constraint method with boundary following, Lahouar et al. 2006, eq. 1-23, in a static scene.
/// Complete for two joints only: with more, motion is confined to one plane per deadlock.
class Boundary : public Planner {
 public:
  explicit Boundary(const PlannerOptions& options);
  PlanResult plan(const PlanProblem& problem) const override;
  std::map<std::string, std::string> options() const override { return in_force_; }

 private:
  std::map<std::string, std::string> in_force_;
  BoundaryOptions options_;
};

}  // namespace clearway
