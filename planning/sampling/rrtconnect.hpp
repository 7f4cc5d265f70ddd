#pragma once

#include "planning/problem/planner.hpp"

namespace clearway {

/// RRT-Connect of OMPL (Kuffner and LaValle 2000) with our certified edges as its motion validator, then
/// shortcuts, each edge certified again. The same seed gives the same path.
class RrtConnect : public Planner {
 public:
  explicit RrtConnect(const PlannerOptions& options);
  PlanResult plan(const PlanProblem& problem) const override;
  std::map<std::string, std::string> options() const override { return in_force_; }

 private:
  std::map<std::string, std::string> in_force_;
  double range_ = 0.0;            ///< longest edge tried, weighted units; 0: OMPL's choice
  double prismatic_scale_ = 0.0;  ///< see joint_weights
  int max_samples_ = 0;
  int shortcuts_ = 0;
};

}  // namespace clearway
