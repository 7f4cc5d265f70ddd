#include "planning/robot/follow_tip.hpp"

#include <Eigen/SVD>
#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <optional>

#include "mapping/system/number_text.hpp"
#include "mapping/system/plain_text.hpp"
#include "planning/robot/goal_configurations.hpp"
#include "planning/robot/puma_branches.hpp"

namespace clearway {
namespace {

// Of the tip's way: m of a full-size arm, rad. Of a joint's: rad, of one that slides m of a full-size arm.
constexpr double longest_stride = 0.02, widest_stride = 0.1;
constexpr double smallest_part = 1.0 / 1024.0;  ///< of such a step, where joints turn fast
constexpr double joint_move_per_step = 0.5;     ///< as far as a joint may come for each step or part of one
constexpr double joined_move = 0.1;  ///< as far as joints come between solutions that belong together

/// The whole turn of `value` that is nearest to `near`.
double turned_near(double value, double near) {
  return near + std::remainder(value - near, 2.0 * std::numbers::pi);
}

std::string limit_reason(const Joint& joint, double limit) {
  const bool slides = joint.kind == JointKind::prismatic;
  return "joint " + quote(joint.name) + " is at its limit of " + short_text(limit, 4) +
         (slides ? " m" : " rad");
}

/// The first joint that no whole turn brings into its limits; empty when all can be.
std::string joint_beyond(const Robot& robot, const Configuration& q, const Configuration& near) {
  for (std::size_t j = 0; j < robot.dof(); ++j) {
    const Joint& joint = robot.joints[j];
    const auto at = static_cast<Eigen::Index>(j);
    const double value = turned_near(q[at], near[at]);
    bool fits = false;
    for (const int turns : {-1, 0, 1}) {
      const double turned = value + 2.0 * std::numbers::pi * turns;
      fits = fits || (turned >= joint.lower && turned <= joint.upper);
    }
    if (!fits) return limit_reason(joint, value > joint.upper ? joint.upper : joint.lower);
  }
  return {};
}

/// How far one joint is from where `from` has it.
double joint_move(const Robot& robot, std::size_t joint, const Configuration& from, const Configuration& q) {
  const auto at = static_cast<Eigen::Index>(joint);
  const double move = std::abs(q[at] - from[at]);
  return robot.joints[joint].kind == JointKind::prismatic ? move / robot.scale : move;
}

/// The joint that is farthest from where `from` has it.
std::size_t farthest_joint(const Robot& robot, const Configuration& from, const Configuration& q) {
  std::size_t farthest = 0;
  for (std::size_t j = 1; j < robot.dof(); ++j)
    if (joint_move(robot, j, from, q) > joint_move(robot, farthest, from, q)) farthest = j;
  return farthest;
}

double largest_move(const Robot& robot, const Configuration& from, const Configuration& q) {
  return joint_move(robot, farthest_joint(robot, from, q), from, q);
}

bool follows_place_alone(const Robot& robot) { return joints_of_tip(robot) < 6; }

Eigen::MatrixXd tip_jacobian(const Robot& robot, const Configuration& q) {
  const Eigen::Vector3d tip = tip_pose(robot, q).translation();
  return jacobian(robot, forward_kinematics(robot, q), robot.tip_link, tip)
      .topRows(follows_place_alone(robot) ? 3 : 6);
}

/// How much more of the tip's motion the same small motions of the joints span at b than near by at a, of
/// directions in which the tip moves at a. 0 or less: in the other orientation, or b is singular.
double spanned_against(const Robot& robot, const Configuration& a, const Configuration& b) {
  constexpr double singular = 1e-7, nearly = 1e-4;  ///< of the tip's motion along its freest direction
  const Eigen::JacobiSVD<Eigen::MatrixXd> svd(tip_jacobian(robot, a),
                                              Eigen::ComputeThinU | Eigen::ComputeThinV);
  const Eigen::VectorXd& values = svd.singularValues();
  const Eigen::Index rank = (values.array() > singular * values[0]).count();
  if (rank == 0) return 1.0;
  const Eigen::MatrixXd at_b =
      svd.matrixU().leftCols(rank).transpose() * tip_jacobian(robot, b) * svd.matrixV().leftCols(rank);
  const double ratio = at_b.determinant() / values.head(rank).prod();
  const bool is_leaving = ratio > 1.0;
  return is_leaving || ratio * values[rank - 1] > nearly * values[0] ? ratio : 0.0;
}

/// Whether the joints keep the arm configuration as they move straight from a to b: they pass no singular
/// one, where what they span is nothing.
bool keep_arm(const Robot& robot, const Configuration& a, const Configuration& b) {
  constexpr double finest_move = 1e-4;
  const double move = largest_move(robot, a, b);
  if (move <= joined_move) {
    const double ratio = spanned_against(robot, a, b);
    if (ratio > 0.5 && (ratio < 2.0 || move < finest_move)) return true;
    if (move < finest_move) return false;
  }
  const Configuration middle = 0.5 * (a + b);
  return keep_arm(robot, a, middle) && keep_arm(robot, middle, b);
}

bool are_joined(const Robot& robot, const Configuration& a, const Configuration& b) {
  return largest_move(robot, a, b) <= joined_move && keep_arm(robot, a, b);
}

/// Part of the way between two poses.
Eigen::Isometry3d between(const Eigen::Isometry3d& a, const Eigen::Isometry3d& b, double part) {
  Eigen::Isometry3d pose = Eigen::Isometry3d::Identity();
  const Eigen::Quaterniond from(a.linear()), to(b.linear());
  pose.linear() = from.slerp(part, to).toRotationMatrix();
  pose.translation() = (1.0 - part) * a.translation() + part * b.translation();
  return pose;
}

/// The straight way of a tip.
struct Way {
  Eigen::Isometry3d begin, end;
  double steps;  ///< 1 at least

  Eigen::Isometry3d at(double part) const { return part == 1.0 ? end : between(begin, end, part); }
  double largest_move() const { return joint_move_per_step * steps; }
};

Way way_of_tip(const Robot& robot, const Eigen::Isometry3d& begin, const Eigen::Isometry3d& end) {
  const double way = (end.translation() - begin.translation()).norm();
  const double turn = Eigen::Quaterniond(begin.linear()).angularDistance(Eigen::Quaterniond(end.linear()));
  return {begin, end,
          std::max({1.0, way / (longest_stride * robot.scale),
                    follows_place_alone(robot) ? 0.0 : turn / widest_stride})};
}

Robot without_limits(Robot robot) {
  for (Joint& joint : robot.joints) {
    joint.lower = -std::numeric_limits<double>::infinity();
    joint.upper = std::numeric_limits<double>::infinity();
  }
  return robot;
}

/// The joint that is farthest beyond its limits; empty when all keep them.
std::string limit_passed(const Robot& robot, const Configuration& q) {
  constexpr double least = 1e-9;  ///< rad or m
  std::string reason;
  double farthest = least;
  for (std::size_t j = 0; j < robot.dof(); ++j) {
    const Joint& joint = robot.joints[j];
    const double value = q[static_cast<Eigen::Index>(j)];
    const double beyond = std::max(joint.lower - value, value - joint.upper);
    if (beyond <= farthest) continue;
    farthest = beyond;
    reason = limit_reason(joint, value > joint.upper ? joint.upper : joint.lower);
  }
  return reason;
}

/// Whether the tip stays within two strides of its place as the joints move straight from a to b.
bool keep_tip_near(const Robot& robot, const Configuration& a, const Configuration& b) {
  const Eigen::Isometry3d place = tip_pose(robot, a);
  constexpr int parts = 16;
  for (int part = 1; part <= parts; ++part)
    if (way_of_tip(robot, place, tip_pose(robot, a + (b - a) * (1.0 * part / parts))).steps > 2.0)
      return false;
  return keep_arm(robot, a, b);
}

/// A robot on the straight way that one call leads it.
class RobotOnItsWay {
 public:
  RobotOnItsWay(const Robot& robot, const Way& way, const Configuration& from)
      : robot_(robot),
        way_(way),
        from_(from),
        q_(from),
        stride_(1.0 / std::min(std::ceil(way.steps), 64.0)) {}

  FollowedTip follow() {
    if (go_straight()) return {q_, true, {}};
    if (are_joints_slower_) return part_towards(*next_);
    // The straight way may leave the workspace where its end does not.
    const auto there = solution(1.0);
    if (there && may_move_to(*there) && keep_arm(robot_, q_, *there)) return {*there, true, {}};
    // Two joints of a singular arm turn against each other, and the tip stays.
    const auto near = stride_ == 1.0 ? there : solution(std::min(1.0, gone_ + stride_));
    if (near && keep_tip_near(robot_, q_, *near)) return part_towards(*near);
    return {q_, false, stop_reason(there)};
  }

 private:
  std::optional<Configuration> solution(double part) const { return solution_of(robot_, part, 0); }

  std::optional<Configuration> solution_of(const Robot& robot, double part, int restarts) const {
    return inverse_kinematics(
        robot, way_.at(part), q_,
        {.max_iterations = 100, .restarts = restarts, .position_only = follows_place_alone(robot)});
  }

  bool may_move_to(const Configuration& q) const {
    return largest_move(robot_, from_, q) <= way_.largest_move();
  }

  /// Goes on in strides and parts of them, as far as neighbouring solutions are joined and joints may move.
  /// True at the way's end; else next_ is what the joints could not follow to, if the tip has a place there.
  bool go_straight() {
    double part = stride_;
    constexpr int most_tries = 128;
    for (int tried = 0; tried < most_tries && part * way_.steps >= smallest_part; ++tried) {
      const double to = std::min(1.0, gone_ + part);
      const bool is_smallest = 0.5 * part * way_.steps < smallest_part;
      next_ = solution(to);
      if (!next_ || !(are_joined(robot_, q_, *next_) || (is_smallest && keep_tip_near(robot_, q_, *next_)))) {
        part *= 0.5;
        continue;
      }
      are_joints_slower_ = !may_move_to(*next_);
      if (are_joints_slower_) return false;
      q_ = *next_;
      gone_ = to;
      if (gone_ == 1.0) return true;
      part = std::min(stride_, 2.0 * part);
    }
    return false;
  }

  /// Why the robot stays where it is. @param there a configuration at the end of the way; empty: none is near
  std::string stop_reason(const std::optional<Configuration>& there) const {
    constexpr int restarts = 16;
    const Robot unlimited = without_limits(robot_);
    if (!there && !solution_of(unlimited, 1.0, restarts)) return reach_reason(unlimited);
    if (const std::string limit = binding_limit(unlimited); !limit.empty()) return limit;
    const std::string singular = "the arm is singular there, or changes its configuration";
    const std::optional<Configuration>& next = next_ ? next_ : there;
    if (!next) return singular;
    return "joint " + quote(robot_.joints[farthest_joint(robot_, q_, *next)].name) +
           " would jump: " + singular;
  }

  std::string reach_reason(const Robot& unlimited) const {
    const IkOptions place_alone{.max_iterations = 100, .position_only = true};
    if (inverse_kinematics(unlimited, way_.end, q_, place_alone))
      return "the arm reaches that place, but not with its tip turned so";
    const double off = (tip_pose(robot_, q_).translation() - way_.end.translation()).norm();
    return "the tip is beyond the arm's reach, " + short_text(off, 2) + " m off";
  }

  /// The joint that would pass its limit on the next part of the way; empty when none would.
  std::string binding_limit(const Robot& unlimited) const {
    for (double part = stride_; part * way_.steps >= smallest_part; part *= 0.5) {
      const auto next = solution_of(unlimited, std::min(1.0, gone_ + part), 0);
      if (!next || !are_joined(robot_, q_, *next)) continue;
      if (std::string limit = limit_passed(robot_, *next); !limit.empty()) return limit;
    }
    return {};
  }

  /// As far as the joints may move in one call.
  FollowedTip part_towards(const Configuration& next) const {
    const double left = way_.largest_move() - largest_move(robot_, from_, q_);
    const Joint& joint = robot_.joints[farthest_joint(robot_, from_, next)];
    return {q_ + (next - q_) * std::min(1.0, left / largest_move(robot_, q_, next)), false,
            "the arm is nearly singular: joint " + quote(joint.name) + " is slower than the hand"};
  }

  const Robot& robot_;
  const Way& way_;
  const Configuration& from_;
  Configuration q_;
  double stride_, gone_ = 0.0;  ///< parts of the way
  std::optional<Configuration> next_;
  bool are_joints_slower_ = false;  ///< than the hand
};

FollowedTip follow_puma(const Robot& robot, const Way& way, const Configuration& from) {
  const auto solution = puma_branches(robot, way.end, from[3])[puma_branch_of(robot, from)];
  if (!solution) return {from, false, "the tip is beyond the arm's reach"};
  if (const auto q = unwrapped_within_limits(robot, *solution, from))
    return largest_move(robot, from, *q) <= way.largest_move() ? FollowedTip{*q, true, {}}
                                                               : RobotOnItsWay(robot, way, from).follow();
  const std::string joint = joint_beyond(robot, *solution, from);
  return {from, false, joint.empty() ? "joints would pass their limits" : joint};
}

}  // namespace

double largest_joint_move(const Robot& robot, const Eigen::Isometry3d& begin, const Eigen::Isometry3d& end) {
  return way_of_tip(robot, begin, end).largest_move();
}

FollowedTip follow_tip(const Robot& robot, const Eigen::Isometry3d& map_from_tip, const Configuration& from) {
  if (!map_from_tip.matrix().allFinite()) return {from, false, "the hand's pose is not known"};
  const Way way = way_of_tip(robot, tip_pose(robot, from), map_from_tip);
  return robot.inverse_kinematics == "puma" ? follow_puma(robot, way, from)
                                            : RobotOnItsWay(robot, way, from).follow();
}

}  // namespace clearway
