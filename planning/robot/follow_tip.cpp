#include "planning/robot/follow_tip.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "mapping/system/number_text.hpp"
#include "mapping/system/plain_text.hpp"
#include "planning/robot/puma_branches.hpp"
#include "planning/robot/reach.hpp"

namespace clearway {
namespace {

constexpr double near_limit = 5e-3;  ///< rad or m: as near as a step and its halvings lead

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

FollowedTip follow_puma(const Robot& robot, const Eigen::Isometry3d& map_from_tip,
                        const Configuration& from) {
  const auto solution = puma_branches(robot, map_from_tip, from[3])[puma_branch_of(robot, from)];
  if (!solution) return {from, false, "the tip is beyond the arm's reach"};
  if (const auto q = unwrapped_within_limits(robot, *solution, from)) return {*q, true, {}};
  const std::string joint = joint_beyond(robot, *solution, from);
  return {from, false, joint.empty() ? "joints would pass their limits" : joint};
}

/// Part of the way between two poses.
Eigen::Isometry3d between(const Eigen::Isometry3d& a, const Eigen::Isometry3d& b, double part) {
  Eigen::Isometry3d pose = Eigen::Isometry3d::Identity();
  const Eigen::Quaterniond from(a.linear()), to(b.linear());
  pose.linear() = from.slerp(part, to).toRotationMatrix();
  pose.translation() = (1.0 - part) * a.translation() + part * b.translation();
  return pose;
}

std::string stop_reason(const Robot& robot, const Eigen::Isometry3d& map_from_tip, const Configuration& q) {
  for (std::size_t j = 0; j < robot.dof(); ++j) {
    const Joint& joint = robot.joints[j];
    const double value = q[static_cast<Eigen::Index>(j)];
    for (const double limit : {joint.lower, joint.upper})
      if (std::abs(value - limit) < near_limit) return limit_reason(joint, limit);
  }
  const double off = (tip_pose(robot, q).translation() - map_from_tip.translation()).norm();
  return "the tip is beyond the arm's reach, " + short_text(off, 2) + " m off";
}

FollowedTip follow_in_steps(const Robot& robot, const Eigen::Isometry3d& map_from_tip,
                            const Configuration& from) {
  const IkOptions options{.max_iterations = 100, .restarts = 0, .position_only = robot.dof() < 6};
  const Eigen::Isometry3d begin = tip_pose(robot, from);
  const double way = (map_from_tip.translation() - begin.translation()).norm();
  const double turn =
      Eigen::Quaterniond(begin.linear()).angularDistance(Eigen::Quaterniond(map_from_tip.linear()));
  constexpr double longest = 0.02, widest = 0.1;  // m of a full-size arm, rad
  const double wanted = std::max(way / (longest * robot.scale), options.position_only ? 0.0 : turn / widest);
  const int steps = static_cast<int>(std::clamp(std::ceil(wanted), 1.0, 64.0));
  const auto at = [&](double part, const Configuration& near) {
    return inverse_kinematics(robot, part == 1.0 ? map_from_tip : between(begin, map_from_tip, part), near,
                              options);
  };
  Configuration q = from;
  double reached = 0.0, missed = 1.0;
  for (int step = 1; step <= steps; ++step) {
    missed = static_cast<double>(step) / steps;
    const auto next = at(missed, q);
    if (!next) break;
    q = *next;
    reached = missed;
    if (step == steps) return {q, true, {}};
  }
  // The straight way may leave the workspace where its end does not.
  if (const auto there = inverse_kinematics(robot, map_from_tip, q, options)) return {*there, true, {}};
  constexpr int halvings = 7;  // to the edge of the workspace
  for (int i = 0; i < halvings; ++i) {
    const double middle = 0.5 * (reached + missed);
    const auto next = at(middle, q);
    (next ? reached : missed) = middle;
    if (next) q = *next;
  }
  return {q, false, stop_reason(robot, map_from_tip, q)};
}

}  // namespace

FollowedTip follow_tip(const Robot& robot, const Eigen::Isometry3d& map_from_tip, const Configuration& from) {
  if (!map_from_tip.matrix().allFinite()) return {from, false, "the hand's pose is not known"};
  return robot.inverse_kinematics == "puma" ? follow_puma(robot, map_from_tip, from)
                                            : follow_in_steps(robot, map_from_tip, from);
}

}  // namespace clearway
