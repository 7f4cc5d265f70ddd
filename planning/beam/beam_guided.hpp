#pragma once

#include "planning/problem/planner.hpp"

namespace clearway {

class OptionReader;

/// What beam_guided may spend, and how it steps.
struct BeamGuidedOptions {
  int width = 3;                ///< k of the beam on the coarse lattice, 1 to 100,000
  double stride = 6.0;          ///< step of that lattice, in the robot's own steps, 1 to 100
  int max_samples = 100000000;  ///< of the trees, 1 to 100,000,000
  double guided_share = 0.6;    ///< of the samples that follow the route, 0 to 1
  double range = 0.0;  ///< longest edge of the trees, weighted units, up to 1e3; 0: a tenth of the extent
  int routes = 4;      ///< for the hand, tried thoroughly in turn, 0 to 100
  int attempts = 120;  ///< to straighten the path, 0 to 1,000,000
  double prismatic_scale = 0.0;  ///< rad per metre, up to 1e6; 0: see joint_weights
};
BeamGuidedOptions read_options(OptionReader& reader, BeamGuidedOptions initial);

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
  using Options = BeamGuidedOptions;
  static constexpr std::string_view table_name = "beam_guided";

  /// @throws std::invalid_argument naming the option that is out of range.
  explicit BeamGuided(const BeamGuidedOptions& options = {});
  PlanResult plan(const PlanProblem& problem) const override;

 private:
  /// Steps 2 and 3; empty when it fails, then status and explanation say why.
  std::vector<Configuration> guided(const PlanProblem& problem, const Eigen::VectorXd& weight,
                                    PlanResult& result) const;

  BeamGuidedOptions options_;
};

}  // namespace clearway
