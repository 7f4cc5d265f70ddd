#include "apps/problem_sets/problem_motion.hpp"

#include <algorithm>
#include <cmath>
#include <stdexcept>

#include "apps/problem_sets/goal_choice.hpp"
#include "apps/problem_sets/problem_values.hpp"
#include "mapping/system/nearest_name.hpp"
#include "mapping/system/number_text.hpp"
#include "mapping/system/plain_text.hpp"

namespace clearway {
namespace {

/// The first goal; where its values are not of all joints, one that says by its link of which they are.
const ForeignGoal& goal_of_motion(const ForeignProblem& problem, const Robot& whole) {
  const ForeignGoal& first = problem.goals.front();
  if (first.joints.values.empty() || first.joints.values.size() == whole.dof()) return first;
  const auto placing = std::find_if(problem.goals.begin(), problem.goals.end(), [&](const ForeignGoal& goal) {
    return goal.pose && joints_above(whole, goal.pose->link).size() == first.joints.values.size();
  });
  return placing != problem.goals.end() ? *placing : first;
}

/// Where the states that the user fixes have the joints that are not planned.
void fix_states(const Robot& whole, const std::vector<std::string>& names,
                const std::set<std::string>& planned, std::map<std::string, double>& fixed) {
  std::vector<std::string> known;
  for (const NamedState& state : whole.states) known.push_back(state.name);
  const std::map<std::string, double> asked = fixed;
  for (const std::string& name : names) {
    const auto state = std::find(known.begin(), known.end(), name) - known.begin();
    if (state == std::ssize(known))
      throw std::invalid_argument("--fix: expected JOINT=VALUE or a state of the robot's SRDF, got " +
                                  quote(name) + ", " + suggestion(name, known));
    const NamedState& said = whole.states[static_cast<std::size_t>(state)];
    for (const Joint& joint : whole.joints) {
      const auto value = said.values.find(joint.name);
      if (value == said.values.end() || planned.contains(joint.name) || asked.contains(joint.name)) continue;
      if (const auto doubt = said.doubts.find(joint.name); doubt != said.doubts.end())
        throw std::invalid_argument("--fix: state " + quote(name) + ": " + doubt->second);
      if (!fixed.emplace(joint.name, value->second).second && fixed.at(joint.name) != value->second)
        throw std::invalid_argument("--fix: two states have joint " + quote(joint.name) +
                                    " at two values, expected one of them or --fix " + joint.name + "=VALUE");
    }
  }
}

/// Where the start has a joint that is not planned, within its limits.
double standing_value(const ForeignProblem& problem, const Joint& joint, double value) {
  const double near = near_limits(joint, value);
  if (near >= joint.lower && near <= joint.upper) return near;
  throw std::invalid_argument("problem " + quote(problem.name) + ", start: joint " + quote(joint.name) +
                              " is at " + short_text(value) + ", expected a number within its limits " +
                              short_text(joint.lower) + " to " + short_text(joint.upper));
}

}  // namespace

WholeRobot load_whole_robot(RobotRequest request) {
  request.group.clear();
  request.fixed.clear();
  request.fixed_states.clear();
  WholeRobot whole{load_robot(request), {}, {}};
  if (!whole.robot.srdf.empty()) whole.srdf = read_srdf(whole.robot.srdf);
  for (const HeldJoint& joint : whole.robot.held) request.moving.insert(joint.name);
  if (request.moving.empty()) return whole;
  whole.held = load_robot(request).joints;
  std::erase_if(whole.held, [&](const Joint& joint) { return !request.moving.contains(joint.name); });
  return whole;
}

ExperimentMotion motion_of(const ForeignProblem& problem, const WholeRobot& known,
                           const RobotRequest& request) {
  const auto& [whole, held, srdf] = known;
  ExperimentMotion motion{problem.experiment.empty() ? problem.group : problem.experiment, request.group,
                          request.fixed};
  if (motion.name.empty()) motion.name = "problems";
  const ForeignGoal& goal = goal_of_motion(problem, whole);
  const bool is_ordered = !goal.joints.values.empty();  // in the robot's order
  if (!is_ordered && motion.group.empty() && srdf && srdf->groups.contains(problem.group))
    motion.group = problem.group;
  std::set<std::string> planned;
  if (!motion.group.empty() && srdf) {
    planned = joints_of_group(whole, *srdf, motion.group, whole.srdf);
  } else if (!is_ordered) {
    for (const auto& [joint, value] : goal.joints.by_joint) planned.insert(joint);
    if (goal.pose)
      for (const std::string& joint : joints_above(whole, goal.pose->link)) planned.insert(joint);
  }
  fix_states(whole, request.fixed_states, planned, motion.fixed);
  if (is_ordered) return motion;
  for (const Joint& joint : whole.joints) {
    const auto start = problem.start.by_joint.find(joint.name);
    if (planned.contains(joint.name) || motion.fixed.contains(joint.name)) continue;
    if (start != problem.start.by_joint.end())
      motion.fixed[joint.name] = standing_value(problem, joint, start->second);
    else if (motion.group.empty())
      motion.fixed[joint.name] = std::clamp(0.0, joint.lower, joint.upper);
  }
  for (const Joint& joint : held) {
    const auto start = problem.start.by_joint.find(joint.name);
    if (start != problem.start.by_joint.end() && !motion.fixed.contains(joint.name))
      motion.fixed[joint.name] = standing_value(problem, joint, start->second);
  }
  return motion;
}

std::map<std::string, std::set<std::string>> lost_joints(const ForeignProblem& problem, const Robot& whole) {
  constexpr double rounding = 1e-3;  // rad or m
  std::map<std::string, std::set<std::string>> lost;
  const auto is_called = [](const auto& list, const std::string& name) {
    return std::any_of(list.begin(), list.end(), [&](const auto& one) { return one.name == name; });
  };
  for (const auto& [joint, value] : problem.start.by_joint) {
    if (is_called(whole.joints, joint) || is_called(whole.held, joint)) continue;
    const auto link = std::find_if(whole.links.begin(), whole.links.end(),
                                   [&](const Link& other) { return other.joint_name == joint; });
    if (link == whole.links.end()) {
      lost["which robot " + quote(whole.name) + " does not have"].insert(joint);
    } else if (link->joint < 0) {
      if (std::abs(value) > rounding && !link->is_held)
        lost["which the robot's file fixes, elsewhere than at 0"].insert(joint);
    } else {
      const auto master =
          problem.start.by_joint.find(whole.joints[static_cast<std::size_t>(link->joint)].name);
      const double followed = master == problem.start.by_joint.end() ? 0.0 : master->second;
      if (std::abs(link->multiplier * followed + link->offset - value) > rounding)
        lost["which follow others, elsewhere than these have them"].insert(joint);
    }
  }
  return lost;
}

}  // namespace clearway
