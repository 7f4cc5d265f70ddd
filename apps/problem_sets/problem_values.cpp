#include "apps/problem_sets/problem_values.hpp"

#include <algorithm>
#include <cmath>
#include <stdexcept>

#include "apps/problem_sets/goal_joints.hpp"
#include "apps/query/query.hpp"
#include "apps/suites/suite_stages.hpp"
#include "mapping/system/nearest_name.hpp"
#include "mapping/system/number_text.hpp"
#include "mapping/system/plain_text.hpp"
#include "planning/robot/kinematics.hpp"

namespace clearway {

double near_limits(const Joint& joint, double value) {
  const double nearest = std::clamp(value, joint.lower, joint.upper);
  return std::abs(nearest - value) <= 1e-3 ? nearest : value;
}

std::vector<double> ordered_values(const Robot& robot, const ForeignProblem& problem,
                                   const ForeignState& state, const char* what) {
  const auto refuse = [&](const std::string& why) {
    throw std::invalid_argument("problem " + quote(problem.name) + ", " + what + ": " + why);
  };
  std::vector<double> result = state.values;
  if (!state.values.empty() || state.by_joint.empty()) {
    if (result.size() != robot.dof())
      refuse("got " + counted(result.size(), "value") + ", expected " + std::to_string(robot.dof()) +
             ", one for each joint of robot " + quote(robot.name) + " (--group and --fix choose which)");
  } else {
    for (const Joint& joint : robot.joints) {
      const auto value = state.by_joint.find(joint.name);
      if (value == state.by_joint.end())
        refuse("expected a value of joint " + quote(joint.name) + " of robot " + quote(robot.name));
      result.push_back(value->second);
    }
  }
  for (std::size_t i = 0; i < result.size(); ++i) result[i] = near_limits(robot.joints[i], result[i]);
  if (const std::string beyond = limit_violation(robot, configuration(result)); !beyond.empty())
    refuse(beyond + (looks_like_degrees(robot, configuration(result)) ? "; are these degrees?" : ""));
  return result;
}

void require_known(const ForeignProblem& problem, const ForeignGoal& goal, const Robot& whole) {
  std::vector<std::string> joints, links;
  for (const Joint& joint : whole.joints) joints.push_back(joint.name);
  for (const Link& link : whole.links) links.push_back(link.name);
  const auto require = [&](const std::string& name, const std::vector<std::string>& known, const char* what) {
    if (std::find(known.begin(), known.end(), name) != known.end()) return;
    throw std::invalid_argument("problem " + quote(problem.name) + ": its goal names " + what + " " +
                                quote(name) + ", which robot " + quote(whole.name) + " does not have, " +
                                suggestion(name, known));
  };
  for (const auto& [joint, value] : goal.joints.by_joint) require(joint, joints, "joint");
  if (goal.pose) require(goal.pose->link, links, "link");
}

void resolve_followers(const ForeignProblem& problem, const Robot& whole, ForeignGoal& goal) {
  auto& values = goal.joints.by_joint;
  for (const Link& link : whole.links) {
    if (link.joint < 0 || link.multiplier == 0.0) continue;
    const std::string& master = whole.joints[static_cast<std::size_t>(link.joint)].name;
    const auto found = values.find(link.joint_name);
    if (link.joint_name == master || found == values.end()) continue;
    const double value = found->second;
    values.erase(found);
    const double at = values.try_emplace(master, (value - link.offset) / link.multiplier).first->second;
    const double follows = link.multiplier * at + link.offset;
    if (std::abs(follows - value) <= 1e-3) continue;
    throw std::invalid_argument("problem " + quote(problem.name) + ": its goal has joint " +
                                quote(link.joint_name) + " at " + short_text(value) + ", which follows " +
                                quote(master) + " and stands at " + short_text(follows));
  }
}

void settle_joints(const ForeignProblem& problem, const Robot& robot, const Configuration& start,
                   ForeignGoal& goal) {
  if (!goal.has_joints()) return;
  try {
    goal.joints.by_joint = allowed_values(goal, robot);
    require_held_as_asked(goal, robot);
    if (goal.pose) {
      const bool has_all = std::all_of(robot.joints.begin(), robot.joints.end(), [&](const Joint& joint) {
        return goal.joints.by_joint.contains(joint.name);
      });
      require_pose_as_asked(
          goal, robot,
          has_all ? configuration(ordered_values(robot, problem, goal.joints, "goal")) : Configuration());
    }
  } catch (const std::invalid_argument& error) {
    throw std::invalid_argument("problem " + quote(problem.name) + ": " + error.what());
  }
  goal.joints.values = ordered_values(robot, problem, goal.joints, "goal");
  if (!goal.bands.empty()) {
    const Configuration nearest = by_whole_turns(robot, configuration(goal.joints.values), start);
    goal.joints.values.assign(nearest.begin(), nearest.end());
  }
  goal.pose.reset();
}

}  // namespace clearway
