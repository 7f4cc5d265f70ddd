#pragma once

#include <Eigen/Core>
#include <optional>
#include <vector>

#include "planning/constraint/control_constraints.hpp"
#include "planning/constraint/local_step.hpp"
#include "planning/problem/planner.hpp"

namespace clearway {

/// Places where the local method was stuck, so that it is not led there again.
class DeadlockMemory {
 public:
  /// @param weight of each joint, @param radius weighted units: nearer than that is the same deadlock
  DeadlockMemory(Eigen::VectorXd weight, double radius) : weight_(std::move(weight)), radius_(radius) {}

  void remember(const Configuration& q) { places_.push_back(weight_.cwiseProduct(q)); }
  bool knows(const Configuration& q) const;
  std::size_t size() const { return places_.size(); }

 private:
  Eigen::VectorXd weight_;
  double radius_;
  std::vector<Eigen::VectorXd> places_;
};

/// How a run ended: at the target; where the local step no longer comes nearer; where it was stuck before;
/// back where the bypass began, or without a way along the boundary; after as many steps as it may take.
enum class RunEnd { reached, deadlock, known_deadlock, no_way_round, used_up, out_of_time };

struct LocalRun {
  RunEnd end = RunEnd::used_up;
  std::vector<Configuration> trace;     ///< where it began first; each edge certified free
  std::vector<WaypointOrigin> origins;  ///< of the trace
  StepConstraints constraints;          ///< where it ended in a deadlock
  LocalStep local;
  int local_steps = 0, boundary_steps = 0;
};

/// The local method (Lahouar et al. 2006, eq. 1-9) from the leg's start towards its goal, both free, for at
/// most `most_steps` steps. Every few steps, and first, the straight edge to the goal is tried. Where ten
/// steps together come nearer by less than one, it counts as stuck.
///
/// With a `direction` (weighted units) it begins by following the boundary in the plane through start, goal
/// and start + direction (Lahouar 2006, section 3, with that direction for q_lim - q_lock in eq. 11) until it
/// is nearer to the goal than it began, or has lost the boundary.
/// @param constraints of the leg's space, made for the damper's influence distance: what limits each step
LocalRun run_local(const PlanProblem& leg, const DamperOptions& damper, ControlConstraints& constraints,
                   const DeadlockMemory& memory, int most_steps,
                   const std::optional<Eigen::VectorXd>& direction = std::nullopt);

/// Constraints as run_local wants them.
ControlConstraints constraints_for(const ConfigurationSpace& space, const DamperOptions& damper);

}  // namespace clearway
