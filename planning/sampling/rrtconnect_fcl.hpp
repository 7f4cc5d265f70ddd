#pragma once

#include <memory>

#include "planning/problem/planner.hpp"

namespace clearway {

class OptionReader;

struct RrtConnectFclOptions {
  double resolution = 0.01;      ///< of the space's extent between two looks at an edge, 1e-6 to 1
  bool simplify = true;          ///< OMPL's path simplification
  double range = 0.0;            ///< longest edge tried, weighted units, up to 1e3; 0: OMPL's choice
  double prismatic_scale = 0.0;  ///< rad per metre, up to 1e6; 0: see joint_weights
  int max_samples = 100000000;   ///< 1 to 100,000,000
};
RrtConnectFclOptions read_options(OptionReader& reader, RrtConnectFclOptions initial);

/// RRT-Connect as most people run it, for comparison: OMPL's with FCL's shapes on an fcl::OcTree, edges
/// looked at every `resolution` of the space's extent, then OMPL's path simplification. What lies between the
/// looks is not checked, so that its paths are NOT certified; have them checked. Start and goal are judged by
/// our space, as for every planner. The same seed gives the same path.
///
/// The tree of blocked voxels is made at the first query in a map and kept for the next ones.
class RrtConnectFcl : public Planner {
 public:
  using Options = RrtConnectFclOptions;
  static constexpr std::string_view table_name = "rrtconnect_fcl";

  /// @throws std::invalid_argument naming the option that is out of range.
  explicit RrtConnectFcl(const RrtConnectFclOptions& options = {});
  ~RrtConnectFcl() override;
  PlanResult plan(const PlanProblem& problem) const override;

 private:
  class Scenes;
  RrtConnectFclOptions options_;
  std::unique_ptr<Scenes> scenes_;
};

}  // namespace clearway
