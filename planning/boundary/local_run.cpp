#include "planning/boundary/local_run.hpp"

#include <algorithm>

#include "planning/boundary/boundary_controller.hpp"
#include "planning/boundary/certified_motion.hpp"

namespace clearway {
namespace {

/// A step below this share of the wanted one is a deadlock.
constexpr double least_share = 0.05;
/// Steps between two looks whether the straight edge to the goal is free.
constexpr int steps_between_looks = 4;

/// As constraints_at, by the constraints of a control step.
StepConstraints step_constraints(ControlConstraints& near, const Configuration& q,
                                 const DamperOptions& damper) {
  near.look(q);
  const auto n = q.size(), count = static_cast<Eigen::Index>(near.constraints().size());
  StepConstraints constraints;
  constraints.matrix.resize(count, n);
  constraints.bounds.resize(count);
  constraints.separation = damper.influence_distance;
  for (Eigen::Index i = 0; i < count; ++i) {
    const auto at = static_cast<std::size_t>(i);
    const ControlConstraint& constraint = near.constraints()[at];
    const Eigen::VectorXd gradient = Eigen::Map<const Eigen::VectorXd>(near.gradient(at).data(), n);
    constraints.matrix.row(i) = gradient.cwiseQuotient(damper.weight).transpose();
    constraints.bounds[i] = damper_bound(damper, constraint.distance);
    constraints.separation = std::min(constraints.separation, constraint.distance);
    constraints.pairs.push_back(
        {gradient, constraint.distance, constraint.body, constraint.point, constraint.normal});
  }
  constraints.lower.resize(n);
  constraints.upper.resize(n);
  for (Eigen::Index j = 0; j < n; ++j) {
    const Joint& joint = near.robot().joints[static_cast<std::size_t>(j)];
    constraints.lower[j] = std::min(0.0, damper.weight[j] * (joint.lower - q[j]));
    constraints.upper[j] = std::max(0.0, damper.weight[j] * (joint.upper - q[j]));
  }
  return constraints;
}

class Runner {
 public:
  Runner(const PlanProblem& leg, const DamperOptions& damper, ControlConstraints& constraints,
         const DeadlockMemory& memory)
      : leg_(leg),
        damper_(damper),
        constraints_(constraints),
        memory_(memory),
        motion_(leg, damper),
        watch_(100.0 * damper.max_step) {
    run_.trace.push_back(leg.start);
    run_.origins.emplace_back();
  }

  LocalRun run(int most_steps, const std::optional<Eigen::VectorXd>& direction) {
    if (direction && !enter(*direction)) return ended(RunEnd::no_way_round);
    for (int step = 0; !motion_.is_at_goal(); ++step) {
      if (leg_.out_of_time()) return ended(RunEnd::out_of_time);
      if (step % steps_between_looks == 0 && sees_goal()) break;
      if (step == most_steps) return ended(RunEnd::used_up);
      if (const auto end = advance()) return ended(*end);
      run_.trace.push_back(motion_.position());
      run_.origins.push_back(motion_.last_origin());
    }
    return ended(RunEnd::reached);
  }

 private:
  LocalRun ended(RunEnd end) {
    run_.end = end;
    return std::move(run_);
  }

  bool sees_goal() {
    if (!leg_.space.is_edge_free(motion_.position(), leg_.goal)) return false;
    run_.trace.push_back(leg_.goal);
    run_.origins.push_back({PathPhase::free_motion, {}, motion_.steps() + 1});
    return true;
  }

  /// The plane at where the run begins; false when there is nothing to follow.
  bool enter(const Eigen::VectorXd& direction) {
    bypass_.emplace();
    look();
    const Eigen::VectorXd here = motion_.weighted_position();
    bypass_->plane = bypass_plane(here, damper_.weight.cwiseProduct(leg_.goal), here + direction);
    bypass_->lock_distance = bypass_->nearest = motion_.distance_to_goal();
    const std::vector<ProjectedConstraint> projected =
        project(run_.constraints, bypass_->plane, damper_.max_step);
    const int first = first_followed(projected, run_.local.multipliers);
    if (first < 0) return false;
    bypass_->followed = bypass_->lock.followed = projected[static_cast<std::size_t>(first)].direction;
    return true;
  }

  void look() {
    // Along a boundary what lies in every direction counts, for a local step what is nearest to each sphere.
    run_.constraints = bypass_ ? constraints_at(leg_.space, motion_.position(), damper_)
                               : step_constraints(constraints_, motion_.position(), damper_);
    wanted_ = step_to_goal(damper_, motion_.position(), leg_.goal);
    run_.local = local_step(run_.constraints, wanted_, damper_);
  }

  /// One step; why the run ends, if it does.
  std::optional<RunEnd> advance() {
    look();
    if (bypass_ && motion_.distance_to_goal() < leave_distance()) end_bypass();
    if (bypass_) return follow();
    if (memory_.knows(motion_.position())) return RunEnd::known_deadlock;
    const bool is_short = run_.local.step.norm() < least_share * wanted_.norm();
    if (is_short || watch_.is_creeping(motion_.distance_to_goal()) || !motion_.take(run_.local.step))
      return RunEnd::deadlock;
    ++run_.local_steps;
    return std::nullopt;
  }

  /// So much nearer than the deadlock that the local method does not fall back into it at once.
  double leave_distance() const {
    const double lock = bypass_->lock_distance;
    return lock - std::min(2.0 * damper_.max_step, 0.2 * lock);
  }

  void end_bypass() {
    bypass_.reset();
    watch_.restart();
  }

  std::optional<RunEnd> follow() {
    if (bypass_->goes_round(motion_.weighted_position(), damper_.max_step)) return RunEnd::no_way_round;
    const std::vector<ProjectedConstraint> projected =
        project(run_.constraints, bypass_->plane, damper_.max_step);
    const int followed = tracked(projected, bypass_->followed);
    if (followed < 0) {  // nothing near any more: nothing to go round
      end_bypass();
      return motion_.take(run_.local.step) ? std::nullopt : std::optional(RunEnd::deadlock);
    }
    const BoundaryStep step = boundary_step(projected, followed, damper_.max_step);
    if (step.is_null) return RunEnd::no_way_round;
    const int source = projected[static_cast<std::size_t>(step.followed)].source;
    if (!motion_.take(bypass_->plane.lift(step.vertex.du),
                      {PathPhase::boundary, followed_name(leg_.space, run_.constraints, source)}))
      return RunEnd::no_way_round;
    bypass_->followed = projected[static_cast<std::size_t>(step.followed)].direction;
    ++bypass_->steps;
    ++run_.boundary_steps;
    return std::nullopt;
  }

  const PlanProblem& leg_;
  const DamperOptions& damper_;
  ControlConstraints& constraints_;
  const DeadlockMemory& memory_;
  CertifiedMotion motion_;
  CreepWatch watch_;
  LocalRun run_;
  Eigen::VectorXd wanted_;
  std::optional<Bypass> bypass_;
};

}  // namespace

bool DeadlockMemory::knows(const Configuration& q) const {
  const Eigen::VectorXd y = weight_.cwiseProduct(q);
  return std::any_of(places_.begin(), places_.end(),
                     [&](const Eigen::VectorXd& place) { return (place - y).norm() < radius_; });
}

LocalRun run_local(const PlanProblem& leg, const DamperOptions& damper, ControlConstraints& constraints,
                   const DeadlockMemory& memory, int most_steps,
                   const std::optional<Eigen::VectorXd>& direction) {
  return Runner(leg, damper, constraints, memory).run(most_steps, direction);
}

ControlConstraints constraints_for(const ConfigurationSpace& space, const DamperOptions& damper) {
  return {space, damper.influence_distance, 0.0};  // of each sphere the nearest voxel alone
}

}  // namespace clearway
