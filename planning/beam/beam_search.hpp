#pragma once

#include <Eigen/Core>
#include <functional>
#include <vector>

#include "planning/beam/beam_lattice.hpp"
#include "planning/beam/node_set.hpp"

namespace clearway {

/// A node selected as the head of a path, with the path that leads to it.
struct Head {
  LatticeIndex node;
  double squared_distance = 0.0;  ///< Chong 2008, eq. 10
  double cost = 0.0;              ///< current-path-cost of Chong 2008, eq. 9
  int parent = -1;                ///< the head before it, -1 for the start
  Eigen::VectorXd forces;         ///< Chong 2008, eq. 8, at the node
};

/// How much the search asked the configuration space.
struct BeamChecks {
  std::uint64_t neighbours = 0, configurations = 0, edges = 0;
};

/// The paths of Chong 2008, Fig. 8, as a tree of heads, and the bookkeeping of its lines 6-14. Memory O(k h).
/// Not for several threads at once.
class BeamPaths {
 public:
  BeamPaths(const PlanProblem& problem, const Lattice& lattice);

  const std::vector<int>& beam() const { return beam_; }  ///< heads to expand, in order of preference
  const Head& head(int i) const { return heads_[static_cast<std::size_t>(i)]; }
  /// Filter 3: selected as a head at any earlier step, also if its path was dropped since.
  const NodeSet& visited() const { return visited_; }
  /// The head at `node` reached from head `parent`: Chong 2008, eq. 9 with the generalized `forces` at the
  /// node.
  Head extend(int parent, const LatticeIndex& node, const Eigen::VectorXd& forces) const;
  /// What its path costs, given also the configurations `from` and `to` of both.
  double cost_through(int parent, const Configuration& from, const Configuration& to,
                      const Eigen::VectorXd& forces) const;

  /// Lines 6-14: the kept heads become the beam; one that reaches the goal leaves it and is saved if it is
  /// the cheapest; paths not cheaper than the saved one are deleted.
  void select(std::vector<Head> kept);

  int steps() const { return steps_; }
  int goal_head() const { return goal_head_; }              ///< -1: none yet
  int first_goal_step() const { return first_goal_step_; }  ///< -1: none yet
  int best_head() const { return best_head_; }              ///< nearest to the goal of all heads
  int head_count() const { return static_cast<int>(heads_.size()); }
  std::vector<Configuration> path_to(int head) const;

 private:
  void admit(Head head);

  const PlanProblem& problem_;
  const Lattice& lattice_;
  int steps_ = 0, goal_head_ = -1, first_goal_step_ = -1, best_head_ = 0;
  std::vector<Head> heads_;
  std::vector<int> beam_;
  NodeSet visited_;
  mutable Eigen::VectorXd step_;  ///< memory of cost_through
};

/// Lines 4-6: the at most k best free neighbours of the beam, in order of preference. Once the problem is out
/// of time the answer does not count any more and may be anything.
using NextHeads = std::function<std::vector<Head>(const PlanProblem&, const Lattice&, const BeamOptions&,
                                                  const BeamPaths&, BeamChecks&)>;

/// Chong 2008, Fig. 8, with the given way of finding the next heads.
PlanResult search_beam(const PlanProblem& problem, const BeamOptions& options, const NextHeads& next_heads);

}  // namespace clearway
