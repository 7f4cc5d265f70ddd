#pragma once

#include <Eigen/Core>
#include <array>
#include <cstdint>
#include <random>
#include <string>
#include <vector>

#include "planning/problem/planner.hpp"
#include "planning/sampling/nearest_nodes.hpp"
#include "planning/sampling/sampled_trees.hpp"

namespace clearway {

/// A tree of configurations at the start and one at the goal, joined by certified edges: traces of the local
/// method are hung into them, samples grow them (RRT-Connect, Kuffner and LaValle 2000, with as many nodes to
/// grow from as the traces gave), the smaller one more often, until an edge joins the two. Where the way to a
/// sample is blocked, two steps aside are tried from where it ended. Nodes beside an obstacle draw no samples
/// from far away (dynamic domain, Yershova et al. 2005). Deterministic for the generator that is given.
class BidirectionalTrees {
 public:
  enum Side { start = 0, goal = 1 };

  struct Node {
    Configuration q;
    int parent = -1;
    bool is_sampled = false;  ///< the edge to the parent is one of the samples', not of the local method
    bool is_beside = false;   ///< an edge from here was not free all along
    int origin = -1;          ///< of a trace's edge to the parent: its origin's number in the tree
  };

  /// The roots are start and goal of the problem, which outlives this object.
  /// @param range longest edge of the samples, weighted units; 0: a tenth of the space's extent
  BidirectionalTrees(const PlanProblem& problem, const Eigen::VectorXd& weight, double range = 0.0);

  const std::vector<Node>& nodes(Side side) const { return trees_[side].nodes; }

  /// Hangs a trace whose first point is node `from` below it; returns the node of its last point.
  /// @param origins of the trace; may be none
  int add_trace(Side side, int from, const std::vector<Configuration>& trace,
                const std::vector<WaypointOrigin>& origins = {});

  /// Tries the straight edges from the nodes from `first` on, spaced by `spacing` (weighted units) and the
  /// last one always, to the other tree's nodes, nearest first and at most `tries` of each. True when one
  /// joins them.
  bool join(Side side, std::size_t first, double spacing, int tries);

  /// Up to `samples` rounds of RRT-Connect; true when the trees are joined.
  /// @param guide the same from call to call, once there is one
  bool grow(int samples, std::mt19937_64& random, const TreeGuide& guide = {});

  bool is_joined() const { return joined_[start] >= 0; }

  /// Joins the trees without an edge: both nodes are the same configuration.
  void join_at(int start_node, int goal_node) { joined_ = {start_node, goal_node}; }

  /// From start to goal. @pre is_joined()
  std::vector<Configuration> path() const;
  /// Of its waypoints: those of traces, and the tree and the node of each sampled edge. @pre is_joined()
  std::vector<WaypointOrigin> path_origins() const;

  /// Share of the path's weighted length that edges of samples make up. @pre is_joined()
  double sampled_share() const;

  /// How many configurations were reached from start and goal, in a sentence for who reads that no path was
  /// found; it says which of them may be walled in: the one whose tree stayed near it where the other's did
  /// not, or stayed small.
  std::string reach() const;

  std::uint64_t edges_checked() const { return edges_checked_; }
  int samples() const { return samples_; }

 private:
  struct Tree {
    explicit Tree(std::size_t joints) : weighted(joints) {}
    std::vector<Node> nodes;
    std::vector<WaypointOrigin> origins;  ///< of traces
    NearestNodes weighted;                ///< the nodes, each joint times its weight
  };

  /// Where an edge from a node ended.
  struct Reached {
    int from = -1;          ///< node; -1: no edge was tried
    int node = -1;          ///< the new one, or `from` where it is the target; -1: none
    bool is_whole = false;  ///< the edge was free all along
  };

  int add(Side side, const Configuration& q, int parent, bool is_sampled);
  WaypointOrigin origin_of(Side side, int node) const;
  int nearest(Side side, const Configuration& q) const;
  bool is_free(const Configuration& from, const Configuration& to);
  Reached extend(Side side, const Configuration& towards, bool from_anywhere);
  bool got_away(Side side) const;
  bool seems_walled_in(Side side) const;
  Reached advance(Side side, int from, const Configuration& towards);
  bool connect(Side side, int node);
  bool step_aside(Side side, int from, std::mt19937_64& random);
  bool step_along(RouteWalk& walk, Side side, std::mt19937_64& random);
  Side next_side() const;
  Configuration draw(std::mt19937_64& random) const;
  double length(const Configuration& a, const Configuration& b) const {
    return weight_.cwiseProduct(b - a).norm();
  }

  const PlanProblem& problem_;
  Eigen::VectorXd weight_, low_, high_;
  Eigen::VectorXd near_low_, near_high_;  ///< one turn about start and goal
  double range_ = 0.0;                    ///< longest edge of the samples, weighted units
  std::array<Tree, 2> trees_;
  std::array<int, 2> joined_{-1, -1};
  std::array<std::size_t, 2> walked_{};  ///< nodes that the walk along a route knows
  std::uint64_t edges_checked_ = 0;
  int samples_ = 0;
};

}  // namespace clearway
