#include "planning/boundary/boundary_controller.hpp"

#include <algorithm>

#include "mapping/system/number_text.hpp"
#include "planning/problem/option_reader.hpp"

namespace clearway {

bool Milestone::is_reached_again(const Eigen::Vector2d& now, const Eigen::Vector2d& now_followed,
                                 double max_step) {
  ++since;
  const double away = (now - place).norm();
  went_away = went_away || away > 2.0 * max_step;
  return went_away && since >= 10 && away <= max_step && followed.dot(now_followed) > 0.0;
}

bool Bypass::goes_round(const Eigen::VectorXd& y, double max_step) {
  const Eigen::Vector2d now = plane.coordinates(y);
  if (lock.is_reached_again(now, followed, max_step)) return true;
  if (steps >= 64 && (steps & (steps - 1)) == 0) latest = {now, followed, 0, false};
  return steps > 64 && latest.is_reached_again(now, followed, 0.5 * max_step);
}

BoundaryChoice BoundaryController::next(const StepConstraints& constraints, const LocalStep& local,
                                        const Eigen::VectorXd& wanted, const Configuration& q,
                                        const Configuration& goal) {
  const double to_goal = options_.weight.cwiseProduct(goal - q).norm();
  if (bypass_) bypass_->nearest = std::min(bypass_->nearest, to_goal);
  if (bypass_ && bypass_->nearest < leave_distance()) end_bypass();
  if (bypass_) {
    BoundaryChoice choice = follow(constraints, q);
    if (bypass_ || !choice.why.empty()) return choice;
  }
  const bool is_creeping = watch_.is_creeping(to_goal);
  const double least = std::max(given_.enter_ratio, deadlock_share) * wanted.norm();
  if (!wanted.isZero(0.0) && (is_creeping || local.step.norm() < least))
    return enter(constraints, local, q, goal);
  ++counts_.local;
  return {local.step, true, ""};
}

double BoundaryController::leave_distance() const {
  // leave_ratio d_lock; with leave_ratio 1 far enough below d_lock that the local step does not fall back
  // into the same deadlock at once.
  const double lock = bypass_->lock_distance;
  return std::min(given_.leave_ratio * lock, lock - std::min(0.1 * options_.max_step, 0.05 * lock));
}

void BoundaryController::end_bypass() {
  bypass_.reset();
  watch_.restart();
}

/// Section 3.2: the plane, d_lock and the first A_lock at a deadlock.
BoundaryChoice BoundaryController::enter(const StepConstraints& constraints, const LocalStep& local,
                                         const Configuration& q, const Configuration& goal) {
  if (q.size() < 2) return stuck(local.step, "Deadlock, and one joint has no way round");
  const Eigen::VectorXd& w = options_.weight;
  Bypass bypass;
  bypass.plane = bypass_plane(w.cwiseProduct(q), w.cwiseProduct(goal),
                              w.cwiseProduct(side_limits(robot_, q, given_.side == BoundarySide::upper)));
  if (q.size() == 2) keep_sense_of_turn(bypass.plane);
  bypass.lock_distance = bypass.nearest = w.cwiseProduct(goal - q).norm();
  const std::vector<ProjectedConstraint> projected = project(constraints, bypass.plane, options_.max_step);
  const int first = first_followed(projected, local.multipliers);
  if (first < 0) return stuck(local.step, "Deadlock without a constraint to follow");
  bypass.followed = bypass.lock.followed = projected[static_cast<std::size_t>(first)].direction;
  ++counts_.deadlocks;
  bypass_ = std::move(bypass);
  return follow(constraints, q);
}

/// Section 3.1: with two joints left and right are defined; the choice of the first deadlock is kept.
void BoundaryController::keep_sense_of_turn(BypassPlane& plane) {
  const double turn = plane.u1[0] * plane.u2[1] - plane.u1[1] * plane.u2[0];
  if (sense_of_turn_ == 0.0) sense_of_turn_ = turn;
  if (turn * sense_of_turn_ < 0.0) plane.u2 = -plane.u2;
}

/// Section 3.3: steps 2-5 of the algorithm.
BoundaryChoice BoundaryController::follow(const StepConstraints& constraints, const Configuration& q) {
  const double max_step = options_.max_step;
  const Eigen::VectorXd still = Eigen::VectorXd::Zero(q.size());
  if (bypass_->goes_round(options_.weight.cwiseProduct(q), max_step)) {
    ++counts_.returns;
    return stuck(still, "Boundary following came back to the deadlock point, never nearer to the goal than " +
                            short_text(bypass_->nearest / bypass_->lock_distance) +
                            " of its distance there (leave_ratio " + to_text(given_.leave_ratio) +
                            "): no path on this side in this plane");
  }
  const std::vector<ProjectedConstraint> projected = project(constraints, bypass_->plane, max_step);
  const int followed = tracked(projected, bypass_->followed);
  if (followed < 0) {  // nothing near any more: nothing to go round
    end_bypass();
    ++counts_.lost;
    return {};
  }
  const BoundaryStep step = boundary_step(projected, followed, max_step);
  if (step.is_null) return stuck(still, "Boundary following found no vertex to move to");
  bypass_->followed = projected[static_cast<std::size_t>(step.followed)].direction;
  counts_.switches += step.switches;
  if (step.relaxed) ++counts_.relaxed;
  ++bypass_->steps;
  ++counts_.boundary;
  return {bypass_->plane.lift(step.vertex.du), false, "",
          projected[static_cast<std::size_t>(step.followed)].source};
}

BoundaryChoice BoundaryController::stuck(const Eigen::VectorXd& step, const std::string& why) {
  end_bypass();
  return {step, true, why};
}

}  // namespace clearway
