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

}  // namespace

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
