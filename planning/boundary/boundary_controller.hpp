#pragma once

#include <Eigen/Core>
#include <optional>
#include <string>

#include "planning/boundary/boundary.hpp"
#include "planning/boundary/boundary_following.hpp"
#include "planning/boundary/certified_motion.hpp"
#include "planning/constraint/local_step.hpp"

namespace clearway {

/// A place on a boundary, to detect when the robot is there again.
struct Milestone {
  Eigen::Vector2d place = Eigen::Vector2d::Zero();     ///< (u1, u2)
  Eigen::Vector2d followed = Eigen::Vector2d::Zero();  ///< direction of the constraint followed there
  int since = 0;                                       ///< steps made since
  bool went_away = false;                              ///< has been more than two steps' length away

  /// Back within max_step, on the same face of the obstacle, after ten steps that led away.
  bool is_reached_again(const Eigen::Vector2d& now, const Eigen::Vector2d& now_followed, double max_step);
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
  bool goes_round(const Eigen::VectorXd& y, double max_step);
};

/// What the method wants at one place.
struct BoundaryChoice {
  Eigen::VectorXd step;  ///< weighted units
  bool is_local = true;  ///< the local step, not one along a boundary
  std::string why;       ///< what ends the method in a static scene; empty while it goes on
  int followed = -1;     ///< along a boundary: the constraint, as LocalStep counts them
};

/// The constraint method with boundary following, Lahouar et al. 2006, eq. 1-23, one step at a time: it keeps
/// what has to be kept from step to step and moves nothing itself, so that one scene may hold many of them.
class BoundaryController {
 public:
  struct Counts {
    int local = 0, boundary = 0, deadlocks = 0, switches = 0, lost = 0, relaxed = 0;
    int returns = 0;  ///< came back to a deadlock point
  };

  /// @param robot, given, options outlive this object
  BoundaryController(const Robot& robot, const BoundaryOptions& given, const DamperOptions& options)
      : robot_(robot), given_(given), options_(options), watch_(options.max_step) {}

  /// The step from q.
  /// @param constraints at q
  /// @param local what Lahouar 2006, eq. 9 makes of the `wanted` step there (step_to_goal, or a shorter one)
  /// When `why` is not empty, the method as published ends here; where things move, one may take the
  /// step all the same (it keeps all constraints) and go on: the boundary is then looked for anew.
  BoundaryChoice next(const StepConstraints& constraints, const LocalStep& local,
                      const Eigen::VectorXd& wanted, const Configuration& q, const Configuration& goal);

  bool is_following() const { return bypass_.has_value(); }
  const Counts& counts() const { return counts_; }

 private:
  BoundaryChoice follow(const StepConstraints& constraints, const Configuration& q);
  BoundaryChoice enter(const StepConstraints& constraints, const LocalStep& local, const Configuration& q,
                       const Configuration& goal);
  BoundaryChoice stuck(const Eigen::VectorXd& step, const std::string& why);
  double leave_distance() const;
  void keep_sense_of_turn(BypassPlane& plane);
  void end_bypass();

  const Robot& robot_;
  const BoundaryOptions& given_;
  const DamperOptions& options_;
  CreepWatch watch_;
  std::optional<Bypass> bypass_;
  Counts counts_;
  double sense_of_turn_ = 0.0;
};

}  // namespace clearway
