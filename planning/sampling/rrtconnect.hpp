#pragma once

#include "planning/problem/planner.hpp"

namespace clearway {

class OptionReader;

/// Options of `rrtconnect`.
struct RrtConnectOptions {
  double range = 0.0;            ///< longest edge tried, weighted units, up to 1e3; 0: a tenth of the extent
  double prismatic_scale = 0.0;  ///< rad per metre, up to 1e6; 0: see joint_weights
  int max_samples = 100000000;   ///< drawn at most, 1 to 100,000,000
  double guided_share = 0.6;     ///< of the samples that follow a route for the hand, after the first 20, 0
                                 ///< to 1; 0: none
  int shortcuts = 100;           ///< tries to shorten the path, 0 to 1,000,000
};
RrtConnectOptions read_options(OptionReader& reader, RrtConnectOptions initial);

/// RRT-Connect (Kuffner and LaValle 2000) on certified edges: the straight edge, then two trees that go as
/// far towards each sample as the way is free; then shortcuts. Once 20 samples have not joined the trees,
/// some of the next ones lead the hand along a way through free space (as in beam_guided). All of its path is
/// certified. The same seed gives the same path.
class RrtConnect : public Planner {
 public:
  using Options = RrtConnectOptions;
  static constexpr std::string_view table_name = "rrtconnect";

  /// @throws std::invalid_argument naming the option that is out of range.
  explicit RrtConnect(const RrtConnectOptions& options = {});
  PlanResult plan(const PlanProblem& problem) const override;

 private:
  RrtConnectOptions options_;
};

}  // namespace clearway
