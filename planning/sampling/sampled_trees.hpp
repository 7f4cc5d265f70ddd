#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <random>
#include <string>
#include <vector>

#include "planning/problem/planner.hpp"
#include "planning/routes/end_effector.hpp"
#include "planning/routes/painted_route.hpp"
#include "planning/routes/route_walk.hpp"

namespace clearway {

/// Proposes a configuration to grow the trees towards, or nothing: then it is drawn uniformly. Draws from the
/// generator that it is given and from nothing else, so that the same seed gives the same trees.
using SampleGuide = std::function<std::optional<Configuration>(std::mt19937_64& random)>;

/// Where trees grow beside uniform samples.
struct TreeGuide {
  SampleGuide sample{};               ///< empty: all other samples are uniform
  std::shared_ptr<RouteWalk> walk{};  ///< of one pair of trees; null: none
  double walk_share = 0.0;            ///< of all rounds that are a step of the walk
};

/// Trees, some of whose rounds follow a route for the hand: most of these go on from where a tree has come,
/// the others put the hand anywhere on it.
/// @param route empty: no guide  @param share of all rounds, 0 to 1  @param problem outlives the guide
TreeGuide guide_along(const PlanProblem& problem, const EndEffector& hand, const EndEffectorRoute& route,
                      double share);

/// Uniform samples before a route for the hand is looked for, which costs as much as some of them: the
/// easiest queries need none.
constexpr int unguided_samples = 20;

struct TreeOptions {
  Eigen::VectorXd weight;  ///< of each joint in lengths, see joint_weights
  double range = 0.0;      ///< longest edge tried, weighted units; 0: a tenth of the space's extent
  int max_samples = 100000000;
  int unguided_samples = 0;                 ///< before a guide is asked for
  std::function<TreeGuide()> find_guide{};  ///< asked once; empty: all samples are uniform
};

struct TreePath {
  std::vector<Configuration> waypoints;   ///< from start to goal; empty: none
  std::vector<WaypointOrigin> origins{};  ///< of the waypoints, or none
  bool is_certified = false;              ///< each edge was certified, or is a part of one that was
  int samples = 0;
  std::string reach{};  ///< how much the trees of start and goal reached: BidirectionalTrees::reach
  std::uint64_t configurations = 0, edges = 0;  ///< checked
  bool out_of_time = false;
};

/// RRT-Connect (Kuffner and LaValle 2000) on certified edges, between start and goal of the problem, which
/// must be free: the straight edge, then two trees that go as far as edges are free. Same seed, same path.
TreePath connect_trees(const PlanProblem& problem, const TreeOptions& options);

/// What a sampling planner answers that found this path, or none: the path is shortened by so many tries of
/// `shortcut`, certified as a whole unless it is already, and costed.
/// @param ends what check_ends said of the problem
PlanResult result_of(const PlanProblem& problem, const PlanResult& ends, TreePath found,
                     const Eigen::VectorXd& weight, int shortcuts);

}  // namespace clearway
