#include "apps/problem_sets/problem_motion.hpp"

#include <algorithm>
#include <set>

#include "apps/problem_sets/goal_choice.hpp"
#include "apps/problem_sets/problem_values.hpp"

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

}  // namespace

ExperimentMotion motion_of(const ForeignProblem& problem, const Robot& whole, const std::optional<Srdf>& srdf,
                           const RobotRequest& request) {
  ExperimentMotion motion{problem.experiment.empty() ? problem.group : problem.experiment, request.group,
                          request.fixed};
  if (motion.name.empty()) motion.name = "problems";
  const ForeignGoal& goal = goal_of_motion(problem, whole);
  if (!goal.joints.values.empty()) return motion;  // in the robot's order
  if (motion.group.empty() && srdf && srdf->groups.contains(problem.group)) motion.group = problem.group;
  std::set<std::string> planned;
  if (!motion.group.empty() && srdf) {
    planned = joints_of_group(whole, *srdf, motion.group, whole.srdf);
  } else {
    for (const auto& [joint, value] : goal.joints.by_joint) planned.insert(joint);
    if (goal.pose)
      for (const std::string& joint : joints_above(whole, goal.pose->link)) planned.insert(joint);
  }
  for (const Joint& joint : whole.joints) {
    const auto start = problem.start.by_joint.find(joint.name);
    if (planned.contains(joint.name) || motion.fixed.contains(joint.name)) continue;
    if (start != problem.start.by_joint.end())
      motion.fixed[joint.name] = near_limits(joint, start->second);
    else if (motion.group.empty())
      motion.fixed[joint.name] = std::clamp(0.0, joint.lower, joint.upper);
  }
  return motion;
}

}  // namespace clearway
