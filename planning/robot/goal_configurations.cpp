#include "planning/robot/goal_configurations.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <random>
#include <stdexcept>

#include "mapping/system/nearest_name.hpp"
#include "mapping/system/plain_text.hpp"
#include "mapping/system/random_unit.hpp"
#include "planning/robot/puma_branches.hpp"
#include "planning/robot/reach.hpp"

namespace clearway {
namespace {

constexpr double same_configuration = 1e-3;  ///< rad or m

double largest_apart(const Configuration& a, const Configuration& b) {
  return (a - b).lpNorm<Eigen::Infinity>();
}

/// Within the limits, or a turn either way of `near`.
Configuration random_start(const Robot& robot, const Configuration& near, std::mt19937_64& random) {
  Configuration q = near;
  for (std::size_t j = 0; j < robot.dof(); ++j) {
    const Joint& joint = robot.joints[j];
    double& value = q[static_cast<Eigen::Index>(j)];
    const double lower = std::isfinite(joint.lower) ? joint.lower : value - std::numbers::pi;
    const double upper = std::isfinite(joint.upper) ? joint.upper : value + std::numbers::pi;
    value = lower + (upper - lower) * random_unit(random);
  }
  return q;
}

constexpr double least_difference = 1e-5;  ///< m and rad, of poses that count as the same

/// Number `index` of the Halton sequence of this base, in (0, 1).
double halton(int index, int base) {
  double value = 0.0, share = 1.0;
  for (; index > 0; index /= base) {
    share /= base;
    value += share * (index % base);
  }
  return value;
}

/// A vector within the ball of radius 1, evenly spread over three numbers from 0 to 1.
Eigen::Vector3d within_ball(double along, double around, double out) {
  const double z = 2.0 * along - 1.0, angle = 2.0 * std::numbers::pi * around;
  const double width = std::sqrt(1.0 - z * z);
  return std::cbrt(out) * Eigen::Vector3d(width * std::cos(angle), width * std::sin(angle), z);
}

Eigen::Isometry3d turned(const Eigen::Isometry3d& pose, const Eigen::Vector3d& by) {
  Eigen::Isometry3d result = pose;
  if (by.norm() > 0.0) result.linear() = pose.linear() * Eigen::AngleAxisd(by.norm(), by.normalized());
  return result;
}

}  // namespace

bool reaches(const GoalPose& goal, const Eigen::Isometry3d& map_from_tip) {
  if ((map_from_tip.translation() - goal.map_from_tip.translation()).norm() >
      goal.position_tolerance + least_difference)
    return false;
  const Eigen::Matrix3d apart = goal.map_from_tip.linear().transpose() * map_from_tip.linear();
  double turn = Eigen::AngleAxisd(apart).angle();
  if (goal.free_axis) {  // what is left when the tip has turned back about its axis as far as it helps
    const Eigen::Vector3d axis = Eigen::Vector3d::Unit(*goal.free_axis);
    turn = std::atan2(axis.cross(apart * axis).norm(), axis.dot(apart * axis));
  }
  return turn <= goal.turn_tolerance + least_difference;
}

std::vector<Eigen::Isometry3d> poses_of(const GoalPose& goal, int count) {
  constexpr int steps = 24;
  std::vector<Eigen::Isometry3d> poses{goal.map_from_tip};
  const Eigen::Vector3d axis = Eigen::Vector3d::Unit(goal.free_axis.value_or(0));
  for (int i = 2; goal.free_axis && i <= steps; ++i) {
    const double turn = 2.0 * std::numbers::pi / steps * (i / 2) * (i % 2 == 0 ? 1.0 : -1.0);
    poses.push_back(turned(goal.map_from_tip, turn * axis));
  }
  if (goal.position_tolerance == 0.0 && goal.turn_tolerance == 0.0) return poses;
  for (int i = 1; i <= count; ++i) {
    const Eigen::Vector3d tilt = within_ball(halton(i, 7), halton(i, 11), halton(i, 13));
    Eigen::Isometry3d pose = turned(goal.map_from_tip, goal.turn_tolerance * tilt);
    if (goal.free_axis) pose = turned(pose, 2.0 * std::numbers::pi * halton(i, 17) * axis);
    pose.translation() += goal.position_tolerance * within_ball(halton(i, 2), halton(i, 3), halton(i, 5));
    poses.push_back(pose);
  }
  return poses;
}

Robot with_tip(const Robot& robot, const std::string& link) {
  std::vector<std::string> names;
  for (const Link& known : robot.links) names.push_back(known.name);
  const auto found = std::find(names.begin(), names.end(), link);
  if (found == names.end())
    throw std::invalid_argument("--tip: robot " + quote(robot.name) + " has no link " + quote(link) +
                                ", did you mean " + quote(nearest_name(link.substr(0, 100), names)) + "?");
  Robot result = robot;
  result.tip_link = static_cast<int>(found - names.begin());
  result.link_from_tip.setIdentity();
  result.inverse_kinematics = "numeric";
  if (!is_moved(result, result.tip_link))
    throw std::invalid_argument("--tip: no joint of robot " + quote(robot.name) + " moves link " +
                                quote(link));
  return result;
}

std::vector<Configuration> goal_configurations(const Robot& robot, const Eigen::Isometry3d& map_from_tip,
                                               const Configuration& near, int starts, std::uint64_t seed) {
  std::vector<Configuration> found;
  const auto add = [&](const Configuration& solution) {
    // A joint that turns more than once reaches the pose by several of its turns.
    const Configuration q = unwrapped_within_limits(robot, solution, near).value_or(solution);
    const bool is_known = std::any_of(found.begin(), found.end(), [&](const Configuration& known) {
      return largest_apart(known, q) <= same_configuration;
    });
    if (!is_known && limit_violation(robot, q).empty()) found.push_back(q);
  };
  if (robot.inverse_kinematics == "puma")
    for (const Configuration& q : puma_inverse_kinematics(robot, map_from_tip)) add(q);
  std::mt19937_64 random(seed);
  const int tries = robot.inverse_kinematics == "puma" ? 0 : starts;
  for (int start = 0; start <= tries; ++start) {
    const Configuration from = start == 0 ? near : random_start(robot, near, random);
    if (const auto q = inverse_kinematics(robot, map_from_tip, from, {.restarts = 0})) add(*q);
  }
  std::stable_sort(found.begin(), found.end(), [&](const Configuration& a, const Configuration& b) {
    return largest_apart(a, near) < largest_apart(b, near);
  });
  return found;
}

}  // namespace clearway
