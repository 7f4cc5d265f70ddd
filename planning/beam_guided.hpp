#pragma once

#include "planning/planner.hpp"

namespace clearway {

/// Ours, beyond Chong et al. 2008: a beam search that is led to the goal by via configurations of its own.
/// 1. `beam` straight at the goal with few steps: most short tasks end here.
/// 2. A route for the hand: through the graph of painted balls (the strokes are a human's way), or through
///    free voxels where nothing is painted. Two trees (RRT-Connect) grow towards configurations whose hand is
///    in the route's regions and join in a rough path; its corner points are the via goals.
/// 3. `beam` from corner to corner; where it stalls, the rough path's own certified edge stands in.
/// 4. An any-angle pass takes out the lattice's detours and lowers the path cost (see any_angle.hpp).
/// Every edge is certified. Same seed, same path.
class BeamGuided : public Planner {
 public:
  explicit BeamGuided(const PlannerOptions& options);
  PlanResult plan(const PlanProblem& problem) const override;
  std::map<std::string, std::string> options() const override { return in_force_; }

 private:
  /// Steps 2 and 3; empty when it fails, then status and explanation say why.
  std::vector<Configuration> guided(const PlanProblem& problem, const Eigen::VectorXd& weight,
                                    const std::vector<double>& steps, PlanResult& result) const;

  std::map<std::string, std::string> in_force_;
  int width_ = 0, max_samples_ = 0, attempts_ = 0, routes_ = 0;
  double stride_ = 0.0;           ///< step of the guided lattice, in the robot's own steps
  double guided_share_ = 0.0;     ///< of the samples that the route proposes
  double range_ = 0.0;            ///< longest edge of the trees; 0: OMPL's choice
  double prismatic_scale_ = 0.0;  ///< see joint_weights
};

}  // namespace clearway
