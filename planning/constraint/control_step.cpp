#include "planning/constraint/control_step.hpp"

#include <algorithm>
#include <cmath>
#include <stdexcept>

#include "mapping/system/number_text.hpp"

namespace clearway {
namespace {

std::span<const double> numbers(const Eigen::VectorXd& vector) {
  return {vector.data(), static_cast<std::size_t>(vector.size())};
}

DamperOptions checked(DamperOptions options, std::size_t joints) {
  const double margin = options.influence_distance - options.security_distance;
  if (!(options.security_distance >= 0.0) || !(margin > 0.0) || !std::isfinite(margin) ||
      !(options.xi > 0.0) || options.xi > margin * (1.0 + 1e-12)) {
    throw std::invalid_argument(
        "control step: expected 0 <= security_distance < influence_distance and 0 < xi <= their difference");
  }
  const auto& weight = options.weight;
  if (weight.size() != static_cast<Eigen::Index>(joints) || !weight.allFinite() ||
      (weight.array() <= 0.0).any())
    throw std::invalid_argument("control step: expected a weight above 0 for each joint");
  if (!(options.max_step > 0.0)) throw std::invalid_argument("control step: expected max_step above 0");
  return options;
}

/// A constraint's right-hand side: the damper's for the nearest voxel; for one that is behind it, that of a
/// longer distance, but never so much that one step crosses the security distance.
double constraint_bound(const DamperOptions& options, const ControlConstraint& constraint) {
  const double bound = damper_bound(options, constraint.distance);
  if (constraint.behind <= 0.0) return bound;
  return std::max(bound, std::min(damper_bound(options, constraint.distance + constraint.behind),
                                  constraint.distance - options.security_distance));
}

}  // namespace

ControlStep::ControlStep(const ConfigurationSpace& space, DamperOptions options)
    : options_(checked(std::move(options), space.robot().dof())), constraints_(space, options_) {
  const auto n = static_cast<Eigen::Index>(space.robot().dof());
  for (Eigen::VectorXd* vector : {&lower_, &upper_, &weighted_gradient_, &step_}) vector->setZero(n);
  per_weight_ = options_.weight.cwiseInverse();
  stand_still();
}

void ControlStep::stand_still() {
  lower_.setZero();
  upper_.setZero();
  solver_.begin(static_cast<int>(lower_.size()));
  solver_.set_limits(numbers(lower_), numbers(upper_));
}

void ControlStep::require_joints(std::size_t count, const char* what) const {
  const std::size_t joints = constraints_.robot().dof();
  if (count != joints)
    throw std::invalid_argument("control step: expected " + counted(joints, "value") + " of " + what +
                                ", one for each joint, got " + std::to_string(count));
}

void ControlStep::look(const Configuration& q) {
  require_joints(static_cast<std::size_t>(q.size()), "q");
  if (!q.allFinite()) throw std::invalid_argument("control step: q holds a number that is not finite");
  constraints_.look(q);
  load(q);
}

void ControlStep::load(const Configuration& q) {
  const Robot& robot = constraints_.robot();
  solver_.begin(static_cast<int>(robot.dof()));
  for (Eigen::Index j = 0; j < q.size(); ++j) {
    const Joint& joint = robot.joints[static_cast<std::size_t>(j)];
    lower_[j] = std::clamp(options_.weight[j] * (joint.lower - q[j]), -options_.max_step, 0.0);
    upper_[j] = std::clamp(options_.weight[j] * (joint.upper - q[j]), 0.0, options_.max_step);
  }
  solver_.set_limits(numbers(lower_), numbers(upper_));
  for (std::size_t i = 0; i < constraints_.constraints().size(); ++i)
    add(constraints_.gradient(i), constraint_bound(options_, constraints_.constraints()[i]));
}

void ControlStep::add(std::span<const double> gradient, double bound) {
  require_joints(gradient.size(), "a gradient");
  for (Eigen::Index j = 0; j < weighted_gradient_.size(); ++j)
    weighted_gradient_[j] = gradient[static_cast<std::size_t>(j)] * per_weight_[j];
  solver_.add_constraint(numbers(weighted_gradient_), bound);
}

const Eigen::VectorXd& ControlStep::solve(const Eigen::VectorXd& wanted) {
  require_joints(static_cast<std::size_t>(wanted.size()), "the wanted step");
  solver_.set_target(numbers(wanted));
  step_.setZero();  // where rounding leaves no step: standing still keeps what demands nothing
  if (!solver_.solve_relaxed()) return step_;
  const Eigen::Map<const Eigen::VectorXd> found(solver_.x().data(), step_.size());
  const double rounding = 1e-6 * options_.max_step;
  if ((found.array() > lower_.array() - rounding).all() && (found.array() < upper_.array() + rounding).all())
    step_ = found.cwiseMax(lower_).cwiseMin(upper_);
  return step_;
}

double ControlStep::separation() const {
  double least = options_.influence_distance;
  for (const ControlConstraint& constraint : constraints_.constraints())
    least = std::min(least, constraint.distance);
  return least;
}

}  // namespace clearway
