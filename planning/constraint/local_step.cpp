#include "planning/constraint/local_step.hpp"

#include <algorithm>
#include <cmath>
#include <stdexcept>

#include "mapping/system/number_text.hpp"
#include "planning/problem/option_reader.hpp"
#include "planning/space/joint_weights.hpp"

namespace clearway {
namespace {

using Eigen::Index;
using Eigen::VectorXd;

double nearest_pair(const ConfigurationSpace& space, const Configuration& q, double limit) {
  double nearest = limit;
  for (const ProximityConstraint& constraint : space.proximity_constraints(q, limit))
    nearest = std::min(nearest, constraint.distance);
  return nearest;
}

/// The farthest that one radian of any joint moves a point of the robot; 0 for prismatic joints only.
double turning_reach(const Robot& robot, const VectorXd& reach) {
  double longest = 0.0;
  for (std::size_t j = 0; j < robot.dof(); ++j) {
    if (robot.joints[j].kind == JointKind::revolute)
      longest = std::max(longest, reach[static_cast<Index>(j)]);
  }
  return longest;
}

/// Four voxels, but between 1/20 and 1/5 of an arm's reach.
double automatic_influence(const Robot& robot, const VectorXd& reach, double resolution) {
  const double longest = turning_reach(robot, reach);
  return longest > 0.0 ? std::clamp(4.0 * resolution, longest / 20.0, longest / 5.0) : 4.0 * resolution;
}

}  // namespace

double damper_bound(const DamperOptions& options, double distance) {  // Lahouar 2006, eq. 4
  return options.xi * (distance - options.security_distance) /
         (options.influence_distance - options.security_distance);
}

VectorXd step_to_goal(const DamperOptions& options, const Configuration& q, const Configuration& goal) {
  if (q.size() != goal.size() || options.weight.size() != q.size())
    throw std::invalid_argument("step to the goal: expected as many values of q, goal and weight, got " +
                                std::to_string(q.size()) + ", " + std::to_string(goal.size()) + " and " +
                                std::to_string(options.weight.size()));
  const VectorXd way = options.weight.cwiseProduct(goal - q);
  const double length = way.norm();  // Lahouar 2006, eq. 1, else 2
  if (!std::isfinite(length))
    throw std::invalid_argument(
        "step to the goal: expected finite values of q and goal, no astronomical ones");
  return length > options.max_step ? VectorXd(way * (options.max_step / length)) : way;
}

StepConstraints constraints_at(const ConfigurationSpace& space, const Configuration& q,
                               const DamperOptions& options) {
  const Robot& robot = space.robot();
  StepConstraints constraints;
  constraints.pairs = space.proximity_constraints(q, options.influence_distance);
  const auto count = static_cast<Index>(constraints.pairs.size());
  constraints.matrix.resize(count, q.size());
  constraints.bounds.resize(count);
  constraints.separation = options.influence_distance;
  for (Index i = 0; i < count; ++i) {
    const ProximityConstraint& pair = constraints.pairs[static_cast<std::size_t>(i)];
    constraints.matrix.row(i) =
        pair.gradient.cwiseQuotient(options.weight).transpose();  // Lahouar 2006, eq. 6, 7
    constraints.bounds[i] = damper_bound(options, pair.distance);
    constraints.separation = std::min(constraints.separation, pair.distance);
  }
  constraints.lower.resize(q.size());
  constraints.upper.resize(q.size());
  for (Index j = 0; j < q.size(); ++j) {
    const Joint& joint = robot.joints[static_cast<std::size_t>(j)];
    constraints.lower[j] = std::min(0.0, options.weight[j] * (joint.lower - q[j]));
    constraints.upper[j] = std::max(0.0, options.weight[j] * (joint.upper - q[j]));
  }
  return constraints;
}

LocalStep local_step(const StepConstraints& constraints, const VectorXd& wanted,
                     const DamperOptions& options) {
  const double longest = options.max_step;
  QuadraticSolution solution =
      solve_relaxed({wanted, constraints.matrix, constraints.bounds, constraints.lower.cwiseMax(-longest),
                     constraints.upper.cwiseMin(longest)});
  if (!solution.feasible) solution.x.setZero();  // rounding only: standing still keeps every constraint
  return {solution.x, solution.multipliers, solution.demand, solution.shares};
}

ConstraintOptions read_options(OptionReader& reader, ConstraintOptions initial) {
  ConstraintOptions options = read_damper_options(reader, initial);
  options.max_steps = reader.integer_or_auto("max_steps", initial.max_steps, 1, 100000000);
  return options;
}

ConstraintOptions read_damper_options(OptionReader& reader, ConstraintOptions initial) {
  return {
      .max_step = reader.number_or_auto("max_step", initial.max_step, 0.0, 10.0),
      .influence_distance = reader.number_or_auto("influence_distance", initial.influence_distance, 0.0, 1e3),
      .security_distance = reader.number_or_auto("security_distance", initial.security_distance, 0.0, 1e3),
      .xi = reader.number_or_auto("xi", initial.xi, 0.0, 1e3),
      .prismatic_scale = reader.number_or_auto("prismatic_scale", initial.prismatic_scale, 0.0, 1e6),
      .max_steps = initial.max_steps};
}

DamperOptions resolve(const ConstraintOptions& given, const PlanProblem& problem) {
  const ConfigurationSpace& space = problem.space;
  const VectorXd reach = joint_reach(space);
  DamperOptions options;
  options.weight = joint_weights(space, given.prismatic_scale);
  options.influence_distance = given.influence_distance > 0.0
                                   ? given.influence_distance
                                   : automatic_influence(space.robot(), reach, space.map().resolution());
  const double d_i = options.influence_distance;
  const double at_ends =
      std::min(nearest_pair(space, problem.start, d_i), nearest_pair(space, problem.goal, d_i));
  options.security_distance = given.security_distance > 0.0
                                  ? given.security_distance
                                  : std::clamp(0.5 * at_ends, 1e-3 * d_i, d_i / 8.0);
  const double margin = d_i - options.security_distance;
  options.xi = given.xi > 0.0 ? given.xi : 0.5 * margin;
  if (!(margin > 0.0) || options.xi > margin * (1.0 + 1e-12)) {
    throw std::invalid_argument("constraint method: security_distance " + to_text(options.security_distance) +
                                ", influence_distance " + to_text(d_i) + ", xi " + to_text(options.xi) +
                                ": expected security < influence and xi <= influence - security");
  }
  const double farthest = reach.cwiseQuotient(options.weight).maxCoeff();
  options.max_step = given.max_step > 0.0 ? given.max_step : farthest > 0.0 ? 0.25 * margin / farthest : 0.02;
  return options;
}

int resolve_max_steps(const ConstraintOptions& given, const DamperOptions& options,
                      const PlanProblem& problem) {
  if (given.max_steps > 0) return given.max_steps;
  const double length = options.weight.cwiseProduct(problem.goal - problem.start).norm();
  return static_cast<int>(std::min(2000.0 + 100.0 * length / options.max_step, 1e6));
}

}  // namespace clearway
