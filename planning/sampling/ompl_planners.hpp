#pragma once

#include "planning/problem/planner.hpp"

namespace clearway {

/// Which of OMPL's sampling planners.
enum class OmplAlgorithm {
  est,      ///< expansive space trees (Hsu, Latombe and Motwani 1999)
  prm,      ///< probabilistic roadmap (Kavraki et al. 1996)
  rrtstar,  ///< RRT* (Karaman and Frazzoli 2011)
  bitstar   ///< batch informed trees (Gammell et al. 2015)
};

/// A sampling planner of OMPL with our certified edges as its motion validator, then shortcuts, each edge
/// certified again: as RrtConnect. `rrtstar` and `bitstar` go on to improve on the weighted length of their
/// path until `max_samples` are drawn or time is out. The same seed gives the same path as long as samples,
/// not time, end the search: all that these planners draw comes from generators of the query's own, but for
/// pivots of OMPL's trees of nearest neighbours, whose answers are exact whatever these are.
class OmplPlanner : public Planner {
 public:
  OmplPlanner(OmplAlgorithm algorithm, const PlannerOptions& options);
  PlanResult plan(const PlanProblem& problem) const override;
  std::map<std::string, std::string> options() const override { return in_force_; }

 private:
  OmplAlgorithm algorithm_;
  std::map<std::string, std::string> in_force_;
  double range_ = 0.0;            ///< longest edge tried, weighted units; 0: OMPL's choice (est, rrtstar)
  int batch_ = 0;                 ///< samples of a batch (bitstar)
  double prismatic_scale_ = 0.0;  ///< see joint_weights
  int max_samples_ = 0;
  int shortcuts_ = 0;
};

}  // namespace clearway
