#pragma once

#include "planning/problem/planner.hpp"

namespace clearway {

/// Ours, beyond Chong et al. 2008: a beam search that is led to the goal by via regions of its own. In turn,
/// until one succeeds:
/// 1. the straight edge; then `beam` on a coarse lattice, as long as it goes well;
/// 2. a route for the hand, through the graph of painted spheres (the strokes are a human's way) or through
/// free
///    voxels where nothing is painted, and a beam through its via regions (see via_beam.hpp), lightly;
/// 3. two trees (RRT-Connect) that grow towards configurations with the hand on the route, briefly;
/// 4. step 2 thoroughly, on other routes too; 5. step 3 up to max_samples.
/// Last comes an any-angle pass, which takes out detours and lowers the path cost (see any_angle.hpp).
/// Every edge is certified. Same seed, same path.
class BeamGuided : public Planner {
 public:
  explicit BeamGuided(const PlannerOptions& options);
  PlanResult plan(const PlanProblem& problem) const override;
  std::map<std::string, std::string> options() const override { return in_force_; }

 private:
  /// Steps 2 and 3; empty when it fails, then status and explanation say why.
  std::vector<Configuration> guided(const PlanProblem& problem, const Eigen::VectorXd& weight,
                                    PlanResult& result) const;

  std::map<std::string, std::string> in_force_;
  int width_ = 0, max_samples_ = 0, attempts_ = 0, routes_ = 0;
  double stride_ = 0.0;           ///< step of the guided lattice, in the robot's own steps
  double guided_share_ = 0.0;     ///< of the samples that the route proposes
  double range_ = 0.0;            ///< longest edge of the trees; 0: OMPL's choice
  double prismatic_scale_ = 0.0;  ///< see joint_weights
};

}  // namespace clearway
