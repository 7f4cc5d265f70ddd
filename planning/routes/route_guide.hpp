#pragma once

#include <optional>
#include <random>

#include "planning/problem/planner.hpp"
#include "planning/routes/end_effector.hpp"
#include "planning/routes/painted_route.hpp"

namespace clearway {

/// A way for the hand from where it is at the start to where it is at the goal: through the graph of painted
/// spheres when the hand has to stay in paint and the map keeps its spheres, else through voxels that its
/// requirement allows. Where the clearance of the hand's middle is less than the hand's outer radius, so that
/// not every attitude of the hand is free, a metre counts up to thirty times; within the spheres `avoided`
/// (map frame) twenty times more. Empty when there is none.
EndEffectorRoute find_end_effector_route(const PlanProblem& problem, const EndEffector& hand,
                                         const std::vector<Sphere>& avoided = {});

/// Proposes configurations whose hand lies in the via regions of a route: a point of the route drawn evenly,
/// moved within its region, and the least motion that brings the hand's middle there from a configuration
/// near the straight way between start and goal, or a random one.
class RouteGuide {
 public:
  /// @param share of the proposals that the guide makes; the others are left to the caller (uniform).
  RouteGuide(const PlanProblem& problem, const EndEffector& hand, EndEffectorRoute route, double share);

  std::optional<Configuration> operator()(std::mt19937_64& random) const;

 private:
  const Robot* robot_;  ///< the problem's
  EndEffector hand_;
  Configuration start_, goal_;
  EndEffectorRoute route_;
  std::vector<double> along_;  ///< length of the route up to each of its points
  double share_;
};

}  // namespace clearway
