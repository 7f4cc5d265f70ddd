#pragma once

#include <Eigen/Core>
#include <vector>

#include "planning/beam/beam_options.hpp"
#include "planning/problem/planner.hpp"

namespace clearway {

/// A node of the lattice: q_j = start_j + index_j epsilon_j.
using LatticeIndex = std::vector<int>;

/// The state lattice around the start, Chong et al. 2008, eq. 4-6, with the measures of eq. 10 and 11.
class Lattice {
 public:
  /// A joint that moves less than its step stays at the start's value: the last edge leads to the goal's.
  /// @throws std::invalid_argument when the number of steps given does not fit the robot
  Lattice(const PlanProblem& problem, const BeamOptions& options);

  Eigen::Index dof() const { return start_.size(); }
  double step(Eigen::Index joint) const { return step_[joint]; }  ///< epsilon_j
  double value(Eigen::Index joint, int index) const { return start_[joint] + index * step_[joint]; }
  Configuration configuration(const LatticeIndex& node) const;
  bool keeps_limits(const LatticeIndex& node) const;

  /// One joint's share of the squared dist_to_goal: (w_j (q_j - q_jG))^2 where index_j = `index`.
  double distance_term(Eigen::Index joint, int index) const;
  /// Squared dist_to_goal, Chong 2008, eq. 10, summed in joint order.
  double squared_distance(const LatticeIndex& node) const;
  /// Chong 2008, eq. 11: |q_j - q_jG| <= epsilon_j for all j (1e-9 epsilon_j granted for rounding).
  bool reaches_goal(const LatticeIndex& node) const;

  /// max_j |q_jG - q_jS| / epsilon_j: the fewest steps that scenario 1 of the paper needs, within one.
  double longest_ramp() const;

 private:
  Configuration start_, goal_;
  Eigen::VectorXd step_, weight_, lower_, upper_;
};

}  // namespace clearway
