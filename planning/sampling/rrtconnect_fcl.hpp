#pragma once

#include <memory>

#include "planning/problem/planner.hpp"

namespace clearway {

/// RRT-Connect as most people run it, for comparison: OMPL's with FCL's shapes on an fcl::OcTree, edges
/// looked at every `resolution` of the space's extent, then OMPL's path simplification. What lies between the
/// looks is not checked, so that its paths are NOT certified; have them checked. Start and goal are judged by
/// our space, as for every planner. The same seed gives the same path.
///
/// The tree of blocked voxels is made at the first query in a map and kept for the next ones.
class RrtConnectFcl : public Planner {
 public:
  explicit RrtConnectFcl(const PlannerOptions& options);
  ~RrtConnectFcl() override;
  PlanResult plan(const PlanProblem& problem) const override;
  std::map<std::string, std::string> options() const override { return in_force_; }

 private:
  class Scenes;
  std::map<std::string, std::string> in_force_;
  double range_ = 0.0;            ///< longest edge tried, weighted units; 0: OMPL's choice
  double prismatic_scale_ = 0.0;  ///< see joint_weights
  double resolution_ = 0.01;      ///< of the space's extent between two looks at an edge
  bool simplify_ = true;
  int max_samples_ = 0;
  std::unique_ptr<Scenes> scenes_;
};

}  // namespace clearway
