#include "apps/problem_sets/goal_joints.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <stdexcept>

#include "apps/console/parse.hpp"
#include "mapping/system/plain_text.hpp"

namespace clearway {
namespace {

constexpr double rounding = 1e-3;  // rad or m, by which files miss a limit

struct Range {
  double lower = -std::numeric_limits<double>::infinity(), upper = std::numeric_limits<double>::infinity();
};

std::string from_to(const Range& range) {
  return "from " + significant(range.lower) + " to " + significant(range.upper);
}

const Joint* joint_of(const Robot& robot, const std::string& name) {
  const auto found = std::find_if(robot.joints.begin(), robot.joints.end(),
                                  [&](const Joint& joint) { return joint.name == name; });
  return found == robot.joints.end() ? nullptr : &*found;
}

/// What all constraints on a joint allow together. Of a joint that turns without limits whole turns do not
/// count. @throws std::invalid_argument when they contradict each other
Range allowed(const ForeignGoal& goal, const std::string& name, double first, bool is_endless) {
  Range range;
  constexpr double slack = 1e-9;
  for (const JointBand& band : goal.bands) {
    if (band.joint != name) continue;
    const double turns = is_endless ? std::round((first - band.position) / (2.0 * std::numbers::pi)) : 0.0;
    const double position = band.position + 2.0 * std::numbers::pi * turns;
    const Range own{position - band.below, position + band.above};
    if (own.lower > range.upper + slack || own.upper < range.lower - slack)
      throw std::invalid_argument("its goal has constraints on joint " + quote(name) +
                                  " that contradict each other: " + from_to(range) + ", and " + from_to(own));
    range = {std::max(range.lower, own.lower), std::min(range.upper, own.upper)};
  }
  if (!std::isfinite(range.lower)) return {first, first};  // no constraint with tolerances: the value
  return {range.lower, std::max(range.lower, range.upper)};
}

}  // namespace

std::map<std::string, double> allowed_values(const ForeignGoal& goal, const Robot& robot) {
  std::map<std::string, double> values;
  for (const auto& [name, first] : goal.joints.by_joint) {
    const Joint* joint = joint_of(robot, name);
    const Range range = allowed(goal, name, first, joint && is_endless(*joint));
    double& value = values[name] = std::clamp(first, range.lower, range.upper);
    if (!joint) continue;
    const double within = std::clamp(value, joint->lower, joint->upper);
    if (within < range.lower - rounding || within > range.upper + rounding)
      throw std::invalid_argument("its goal has joint " + quote(name) + " at " + significant(value) +
                                  ", expected a value within its limits, " +
                                  from_to({joint->lower, joint->upper}));
    value = within;
  }
  return values;
}

void require_held_as_asked(const ForeignGoal& goal, const Robot& robot) {
  for (const HeldJoint& held : robot.held) {
    const auto asked = goal.joints.by_joint.find(held.name);
    if (asked == goal.joints.by_joint.end()) continue;
    const Range range = allowed(goal, held.name, asked->second, false);
    if (held.value >= range.lower - rounding && held.value <= range.upper + rounding) continue;
    throw std::invalid_argument(
        "its goal has joint " + quote(held.name) + " at " + significant(asked->second) + ", which " +
        (robot.group.empty() ? "does not move" : "group " + quote(robot.group) + " does not move") +
        " and stands at " + significant(held.value));
  }
}

void require_pose_as_asked(const ForeignGoal& goal, const Robot& robot, const Configuration& q) {
  const std::string what = "its goal asks for joint values and for a pose of link " + quote(goal.pose->link);
  if (q.size() == 0)
    throw std::invalid_argument(what + " at once, expected one of them or values of all joints");
  const auto link = std::find_if(robot.links.begin(), robot.links.end(),
                                 [&](const Link& known) { return known.name == goal.pose->link; });
  const LinkPoses map_from = forward_kinematics(robot, q);
  const Eigen::Isometry3d at =
      map_from[static_cast<std::size_t>(link - robot.links.begin())] * Eigen::Translation3d(goal.pose->point);
  const GoalPose& pose = goal.pose->pose;
  if (reaches(pose, at)) return;
  const double away = (at.translation() - pose.map_from_tip.translation()).norm();
  const double turned = Eigen::AngleAxisd(pose.map_from_tip.linear().transpose() * at.linear()).angle();
  throw std::invalid_argument(what + ", which these values miss: they are " + significant(away) + " m and " +
                              significant(turned) + " rad from it");
}

}  // namespace clearway
