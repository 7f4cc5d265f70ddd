#pragma once

#include <Eigen/Core>
#include <map>
#include <string>
#include <vector>

#include "planning/constraint/quadratic_program.hpp"
#include "planning/problem/planner.hpp"
#include "planning/space/configuration_space.hpp"

namespace clearway {

/// Parameters of the constraint method, Lahouar et al. 2006, eq. 1-9. Joint-space lengths are in weighted
/// units y = w q: radians, and metres times prismatic_scale (see joint_weights).
struct DamperOptions {
  double max_step = 0.0;            ///< Delta q_max of Lahouar 2006, eq. 1, and the box, weighted units, > 0
  double influence_distance = 0.0;  ///< d_i, metres: nearer objects are constraints
  double security_distance = 0.0;   ///< d_s, metres: where approach stops, < d_i
  double xi = 0.0;                  ///< xi, metres per step: approach allowed at d_i, <= d_i - d_s
  Eigen::VectorXd weight;           ///< w_j
};

/// Right-hand side of the velocity damper, xi (d - d_s) / (d_i - d_s): xi at d_i, 0 at d_s, negative
/// (separation demanded) below. Our copy of Lahouar 2006 prints eq. 4-9 with d_i and d_s exchanged.
double damper_bound(const DamperOptions& options, double distance);

/// Lahouar 2006, eq. 1-2: straight at the goal, at most max_step long. Weighted units.
/// @throws std::invalid_argument when q, goal and the options' weight differ in size, and where their
/// difference is not finite
Eigen::VectorXd step_to_goal(const DamperOptions& options, const Configuration& q, const Configuration& goal);

/// Everything that limits the next step from q, in weighted units: Lahouar 2006, eq. 6-7 for each near pair,
/// and the box of joint limits and max_step.
struct StepConstraints {
  Eigen::MatrixXd matrix;                  ///< a_i / w
  Eigen::VectorXd bounds;                  ///< b_i, damper_bound
  Eigen::VectorXd lower, upper;            ///< joint limits only, about q; <= 0 and >= 0
  std::vector<ProximityConstraint> pairs;  ///< what each constraint stands for
  double separation = 0.0;  ///< smallest distance of all pairs; influence_distance when there is none
};
StepConstraints constraints_at(const ConfigurationSpace& space, const Configuration& q,
                               const DamperOptions& options);

/// Lahouar 2006, eq. 9: the step nearest to `wanted` that keeps all constraints. When they contradict each
/// other, the demanded separations are relaxed together (solve_relaxed); `demand` < 1 shows it.
struct LocalStep {
  Eigen::VectorXd step;         ///< weighted units
  Eigen::VectorXd multipliers;  ///< >= 0: inequalities, then upper, then lower limits; > 0: active
  double demand = 1.0;
  Eigen::VectorXd shares;  ///< of each demand what was kept; 1 where nothing gave way
};
LocalStep local_step(const StepConstraints& constraints, const Eigen::VectorXd& wanted,
                     const DamperOptions& options);

/// Options of the constraint method as given; 0 stands for "auto", by the rules in planning/METHODS.md.
struct ConstraintOptions {
  double max_step = 0.0;            ///< Delta q_max: the longest step, weighted units, up to 10
  double influence_distance = 0.0;  ///< d_i, metres: nearer objects are constraints, up to 1e3
  double security_distance = 0.0;   ///< d_s, metres: where approach stops, up to 1e3
  double xi = 0.0;                  ///< xi, metres per step: approach allowed at d_i, up to 1e3
  double prismatic_scale = 0.0;     ///< rad per metre, up to 1e6, see joint_weights
  int max_steps = 0;                ///< of the whole run, 1 to 100,000,000
};
class OptionReader;
ConstraintOptions read_options(OptionReader& reader, ConstraintOptions initial);
/// All of them but max_steps.
ConstraintOptions read_damper_options(OptionReader& reader, ConstraintOptions initial);

/// The values in force for this problem.
/// @throws std::invalid_argument unless 0 <= d_s < d_i and 0 < xi <= d_i - d_s.
DamperOptions resolve(const ConstraintOptions& given, const PlanProblem& problem);
int resolve_max_steps(const ConstraintOptions& given, const DamperOptions& options,
                      const PlanProblem& problem);

}  // namespace clearway
