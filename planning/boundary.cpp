#include "planning/boundary.hpp"

#include <algorithm>
#include <optional>

#include "planning/boundary_following.hpp"
#include "planning/certified_motion.hpp"
#include "planning/option_reader.hpp"

namespace clearway {
namespace {

/// With enter_ratio 0, a local step shorter than this share of the wanted one is null.
constexpr double kDeadlock = 1e-4;

/// A place on a boundary, to tell when the robot is there again.
struct Milestone {
  Eigen::Vector2d place = Eigen::Vector2d::Zero();     ///< (u1, u2)
  Eigen::Vector2d followed = Eigen::Vector2d::Zero();  ///< direction of the row followed there
  int since = 0;                                       ///< steps made since
  bool went_away = false;                              ///< has been more than two steps' length away

  /// Back within max_step, on the same face of the obstacle, after ten steps that led away.
  bool is_reached_again(const Eigen::Vector2d& now, const Eigen::Vector2d& now_followed, double max_step) {
    ++since;
    const double away = (now - place).norm();
    went_away = went_away || away > 2.0 * max_step;
    return went_away && since >= 10 && away <= max_step && followed.dot(now_followed) > 0.0;
  }
};

/// One run along a boundary, from a deadlock on.
struct Bypass {
  BypassPlane plane;
  double lock_distance = 0.0;                          ///< d_lock
  double nearest = 0.0;                                ///< smallest ||q - q_goal|| so far
  Eigen::Vector2d followed = Eigen::Vector2d::Zero();  ///< direction of A_lock
  int steps = 0;
  Milestone lock;    ///< the deadlock point itself
  Milestone latest;  ///< set anew after 64, 128, 256, ... steps

  /// Back at the deadlock point, or on a round that does not pass it (a boundary lost for another one).
  bool goes_round(const Eigen::VectorXd& y, double max_step) {
    const Eigen::Vector2d now = plane.coordinates(y);
    if (lock.is_reached_again(now, followed, max_step)) return true;
    if (steps >= 64 && (steps & (steps - 1)) == 0) latest = {now, followed, 0, false};
    return steps > 64 && latest.is_reached_again(now, followed, 0.5 * max_step);
  }
};

/// The motion of one query: local steps, and a bypass while there is one.
class BoundaryMotion {
 public:
  BoundaryMotion(const PlanProblem& problem, const BoundaryOptions& given)
      : problem_(problem),
        given_(given),
        options_(resolve(given.local, problem)),
        max_steps_(resolve_max_steps(given.local, options_, problem)),
        motion_(problem, options_),
        watch_(options_.max_step) {}

  PlanResult run(const PlanResult& ends) {
    std::string failure;
    while (failure.empty() && !motion_.is_at_goal()) {
      if (problem_.out_of_time()) return finish(ends, PlanStatus::timed_out, "Out of time.");
      failure = motion_.steps() >= max_steps_ ? stopped("Reached max_steps") : advance();
    }
    return finish(
        ends, failure.empty() ? PlanStatus::solved : PlanStatus::no_path,
        failure.empty() ? "Reached the goal after " + std::to_string(deadlocks_) + " deadlocks." : failure);
  }

 private:
  /// One step. Returns why the motion ends, or nothing.
  std::string advance() {
    constraints_ = constraints_at(problem_.space, motion_.position(), options_);
    const Eigen::VectorXd wanted = step_to_goal(options_, motion_.position(), problem_.goal);
    local_ = local_step(constraints_, wanted, options_);
    motion_.note(constraints_, local_);
    if (bypass_) bypass_->nearest = std::min(bypass_->nearest, motion_.distance_to_goal());
    if (bypass_ && bypass_->nearest < leave_distance()) end_bypass();
    if (bypass_) return follow_boundary();
    const bool is_creeping = watch_.is_creeping(motion_.distance_to_goal());
    const double least = std::max(given_.enter_ratio, kDeadlock) * wanted.norm();
    if (is_creeping || local_.step.norm() < least) return enter_bypass();
    ++local_steps_;
    return motion_.take(local_.step) ? "" : stopped("The next local step could not be certified free");
  }

  /// Below it the local method is resumed: leave_ratio d_lock, and with leave_ratio 1 far enough below d_lock
  /// that the local step does not fall back into the same deadlock at once.
  double leave_distance() const {
    const double lock = bypass_->lock_distance;
    return std::min(given_.leave_ratio * lock, lock - std::min(0.1 * options_.max_step, 0.05 * lock));
  }

  void end_bypass() {
    bypass_.reset();
    watch_.restart();
  }

  /// Section 3.2: the plane, d_lock and the first A_lock at a deadlock.
  std::string enter_bypass() {
    if (problem_.start.size() < 2) return stopped("Deadlock, and one joint has no way round");
    const Eigen::VectorXd& w = options_.weight;
    const Configuration limit = side_limits(problem_.space.robot(), motion_.position(), given_.upper);
    Bypass bypass;
    bypass.plane =
        bypass_plane(motion_.weighted_position(), w.cwiseProduct(problem_.goal), w.cwiseProduct(limit));
    if (problem_.start.size() == 2) keep_sense_of_turn(bypass.plane);
    bypass.lock_distance = bypass.nearest = motion_.distance_to_goal();
    const std::vector<ProjectedRow> rows = project(constraints_, bypass.plane, options_.max_step);
    const int first = first_followed(rows, local_.multipliers);
    if (first < 0) return stopped("Deadlock without a constraint to follow");
    bypass.followed = bypass.lock.followed = rows[static_cast<std::size_t>(first)].direction;
    ++deadlocks_;
    bypass_ = std::move(bypass);
    return follow_boundary();
  }

  /// Section 3.1: with two joints left and right are defined; the choice of the first deadlock is kept.
  void keep_sense_of_turn(BypassPlane& plane) {
    const double turn = plane.u1[0] * plane.u2[1] - plane.u1[1] * plane.u2[0];
    if (sense_of_turn_ == 0.0) sense_of_turn_ = turn;
    if (turn * sense_of_turn_ < 0.0) plane.u2 = -plane.u2;
  }

  /// Section 3.3: steps 2-5 of the algorithm.
  std::string follow_boundary() {
    const double max_step = options_.max_step;
    if (bypass_->goes_round(motion_.weighted_position(), max_step)) {
      return stopped("Boundary following came back to the deadlock point, never nearer to the goal than " +
                     short_text(bypass_->nearest / bypass_->lock_distance) +
                     " of its distance there (leave_ratio " + to_text(given_.leave_ratio) +
                     "): no path on this side in this plane");
    }
    const std::vector<ProjectedRow> rows = project(constraints_, bypass_->plane, max_step);
    const int followed = tracked(rows, bypass_->followed);
    if (followed < 0) {  // nothing near any more: nothing to go round
      end_bypass();
      ++lost_;
      return "";
    }
    const BoundaryStep step = boundary_step(rows, followed, max_step);
    if (step.is_null) return stopped("Boundary following found no vertex to move to");
    bypass_->followed = rows[static_cast<std::size_t>(step.followed)].direction;
    switches_ += step.switches;
    if (step.relaxed) ++relaxed_vertices_;
    ++bypass_->steps;
    ++boundary_steps_;
    return motion_.take(bypass_->plane.lift(step.vertex.du)) ? ""
                                                             : stopped(
                                                                   "The next step along the boundary could "
                                                                   "not be certified free");
  }

  std::string stopped(const std::string& why) const {
    return why + ", after " + std::to_string(motion_.steps()) + " steps and " + std::to_string(deadlocks_) +
           " deadlocks, " + short_text(motion_.distance_to_goal()) + " from the goal in joint space: " +
           holding_back(problem_.space, constraints_, local_.multipliers) + ".";
  }

  PlanResult finish(const PlanResult& ends, PlanStatus status, const std::string& explanation) const {
    PlanResult result = motion_.result(ends, status, explanation);
    result.statistics["steps_local"] = local_steps_;
    result.statistics["steps_boundary"] = boundary_steps_;
    result.statistics["deadlocks"] = deadlocks_;
    result.statistics["constraint_switches"] = switches_;
    result.statistics["boundaries_lost"] = lost_;
    result.statistics["vertices_relaxed"] = relaxed_vertices_;
    return result;
  }

  const PlanProblem& problem_;
  const BoundaryOptions& given_;
  const DamperOptions options_;
  const int max_steps_;
  CertifiedMotion motion_;
  CreepWatch watch_;
  StepConstraints constraints_;
  LocalStep local_;
  std::optional<Bypass> bypass_;
  double sense_of_turn_ = 0.0;
  int local_steps_ = 0, boundary_steps_ = 0, deadlocks_ = 0, switches_ = 0, lost_ = 0, relaxed_vertices_ = 0;
};

}  // namespace

Boundary::Boundary(const PlannerOptions& options) {
  OptionReader reader("boundary", options);
  options_.local = read_constraint_options(reader);
  options_.enter_ratio = reader.number("enter_ratio", options_.enter_ratio, 0.0, 0.99);
  options_.leave_ratio = reader.number("leave_ratio", options_.leave_ratio, 0.01, 1.0);
  options_.upper = reader.choice("side", "upper", {"upper", "lower"}) == "upper";
  reader.refuse_unknown();
  in_force_ = reader.in_force();
}

PlanResult Boundary::plan(const PlanProblem& problem) const {
  const PlanResult ends = check_ends(problem);
  if (ends.status != PlanStatus::solved) return ends;
  return BoundaryMotion(problem, options_).run(ends);
}

}  // namespace clearway
