#pragma once

#include <Eigen/Core>
#include <span>

#include "planning/constraint/control_constraints.hpp"
#include "planning/constraint/local_step.hpp"
#include "planning/constraint/quadratic_solver.hpp"

namespace clearway {

/// One step of the constraint method (Lahouar et al. 2006, eq. 1-9) in microseconds, for a control loop:
/// kinematics, constraints (ControlConstraints) and the quadratic program, in memory that is kept. In turn:
/// look, then add (constraints against other robots and moving shapes), then solve. The paper has one
/// constraint for each pair of objects, at its minimum distance; a voxel map is one object, and the voxel
/// that is nearest changes all the time, its direction with it. So the nearest voxel of each sphere has the
/// paper's bound, and those that may soon be the nearest have it, too, at a distance longer by how far they
/// are behind: they give way the sooner the less they matter, and take over without a jump. No bound lets one
/// step cross the security distance of what has a constraint; what lies beyond d_i, or is farther from a
/// distant sphere than its nearest cube, has none, so that steps which move a point by more than (d_i -
/// d_s)/2 can come nearer than d_s. Certified edges remain the proof.
class ControlStep {
 public:
  /// @param space must live as long. @throws std::invalid_argument unless 0 <= d_s < d_i and
  ///        0 < xi <= d_i - d_s, and a weight > 0 for each joint
  ControlStep(const ConfigurationSpace& space, DamperOptions options);

  /// Constraints at q, and the room to the joint limits.
  /// @throws std::invalid_argument, as add and solve do, for another number of values than joints, and for
  /// values that are not finite
  void look(const Configuration& q);

  /// As before the first look.
  void stand_still();

  /// One more constraint: gradient . dq <= bound, in joint units (not weighted).
  void add(std::span<const double> gradient, double bound);

  /// Lahouar 2006, eq. 9: the step nearest to `wanted` (weighted units) that keeps all constraints;
  /// constraints that contradict each other as in QuadraticSolver::solve_relaxed. Before the first look it
  /// is zero. Never beyond the joint
  /// limits and max_step a joint: where rounding leaves no such step it is zero, and solver() reports the
  /// step that was refused. Valid until the next call.
  const Eigen::VectorXd& solve(const Eigen::VectorXd& wanted);

  const DamperOptions& options() const { return options_; }
  const ControlConstraints& constraints() const { return constraints_; }
  ControlConstraints& constraints() { return constraints_; }
  /// Of the last solve: its multipliers (constraints of look, of add, upper, lower limits) and shares.
  const QuadraticSolver& solver() const { return solver_; }
  /// Smallest distance of all constraints; the influence distance when there is none. What no step can bring
  /// to its damper has none, nor a voxel out of the body's reach.
  double separation() const;

  /// The second half of `look`, for who measures it.
  void load(const Configuration& q);

 private:
  void require_joints(std::size_t count, const char* what) const;

  DamperOptions options_;
  ControlConstraints constraints_;
  QuadraticSolver solver_;
  Eigen::VectorXd per_weight_, lower_, upper_, weighted_gradient_, step_;
};

}  // namespace clearway
