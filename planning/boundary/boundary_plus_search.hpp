#pragma once

#include <array>
#include <random>
#include <string>

#include "planning/boundary/boundary_plus.hpp"
#include "planning/boundary/local_run.hpp"
#include "planning/sampling/bidirectional_trees.hpp"

namespace clearway {

/// Directions of bypassing planes at a deadlock (weighted units), in the order tried: 0 over the obstacle and
/// 1 under it (the joint motion that takes the point which blocks along the obstacle's face, upwards and
/// downwards), 2 and 3 to its sides, 4 towards all upper joint limits (Lahouar 2006, eq. 11), 5 towards all
/// lower ones, from 6 on random ones.
Eigen::VectorXd plane_direction(int plane, const ConfigurationSpace& space, const DamperOptions& damper,
                                const Configuration& lock, const LocalRun& stuck, std::mt19937_64& random);
std::string plane_name(int plane);

/// The search of boundary_plus for one problem.
class BoundaryPlusSearch {
 public:
  BoundaryPlusSearch(const PlanProblem& problem, const BoundaryPlusOptions& options,
                     const DamperOptions& damper);

  /// The straight edge; few samples of trees; the local method from both ends; then, in rounds, a plane from
  /// both deadlocks and a hand-over, each with twice as many samples as the last.
  BoundaryPlusStage solve();

  const BidirectionalTrees& trees() const { return trees_; }
  const std::string& how() const { return how_; }  ///< which stage joined them, in words
  std::string effort() const;                      ///< what was spent, in words
  /// From the start to the deadlock nearest to the goal.
  std::vector<Configuration> explored() const;
  void add_statistics(PlanResult& result) const;

 private:
  using Side = BidirectionalTrees::Side;

  /// Where one side is stuck.
  struct Lock {
    int node = 0;
    LocalRun run;
  };

  /// Runs from a node towards the other side's root and hangs the trace into the tree.
  bool run(Side side, int node, int most_steps, const std::optional<Eigen::VectorXd>& direction);
  bool by_local_method();
  bool by_plane(int plane);
  bool by_trees(int samples);
  bool by_hand_over(int samples);
  bool back_to_local_method();
  void guide_samples();

  const PlanProblem& problem_;
  const BoundaryPlusOptions& options_;
  const DamperOptions& damper_;
  ControlConstraints constraints_;
  BidirectionalTrees trees_;
  std::mt19937_64 random_;
  std::array<Lock, 2> locks_;
  std::array<DeadlockMemory, 2> memory_;
  TreeGuide guide_;
  bool is_guided_ = false;
  std::string how_;
  int local_steps_ = 0, boundary_steps_ = 0, planes_ = 0, handed_back_ = 0, rounds_ = 0;
};

}  // namespace clearway
