#include "apps/check/robot_terms.hpp"

#include <algorithm>
#include <set>
#include <stdexcept>
#include <utility>

#include "apps/console/parse.hpp"
#include "apps/query/query.hpp"
#include "mapping/system/plain_text.hpp"
#include "planning/robot_files/load_robot.hpp"

namespace clearway {
namespace {

/// @pre no flag chooses a group
RobotRequest without_choices(const RobotChoice& choice) {
  RobotRequest request = robot_request(choice);
  request.fixed.clear();
  request.fixed_states.clear();
  request.standing.clear();
  return request;
}

Term<std::string> group_of(const CheckOptions& options, const Robot& robot) {
  if (!options.robot.group.empty()) return {robot.group, TermSource::flag};
  if (robot.group.empty()) return {};
  const bool is_own = robot.group == load_robot(without_choices(options.robot)).group;
  return {robot.group, is_own ? TermSource::by_default : TermSource::plan};
}

/// One note for each joint that the plan holds elsewhere than the robot's own files do.
void note_held(const CheckOptions& options, const Contract& contract, const Robot& robot,
               std::vector<std::string>& notes) {
  const auto is_plans = [](const auto& joint) { return joint.second.source == TermSource::plan; };
  if (std::none_of(contract.held.begin(), contract.held.end(), is_plans)) return;
  RobotRequest request = robot_request(options.robot);
  request.group = robot.group;
  request.standing.clear();
  const Robot own = load_robot(request);
  for (const auto& [name, term] : contract.held) {
    if (term.source != TermSource::plan) continue;
    const auto by_default = std::find_if(own.held.begin(), own.held.end(),
                                         [&](const HeldJoint& joint) { return joint.name == name; });
    if (by_default == own.held.end())
      notes.push_back("joint " + shortened(name) + " stands at " + significant(term.value) +
                      " by the plan; by default it moves");
    else if (by_default->value != term.value)
      notes.push_back("joint " + shortened(name) + " stands at " + significant(term.value) +
                      " by the plan; by default at " + significant(by_default->value));
  }
}

/// The robot is the user's word, with what its .xacro was expanded with; a plan of another one is judged for
/// it, and the user told.
void note_xacro(const Robot& robot, const Plan& plan, std::vector<std::string>& notes) {
  if (plan.xacro == robot.xacro) return;
  const auto told = [](const std::map<std::string, std::string>& arguments) {
    std::string text;
    for (const auto& [name, value] : arguments) text += (text.empty() ? "" : " ") + name + ":=" + value;
    return text.empty() ? std::string("none") : shortened(text);
  };
  notes.push_back("the plan was made with other xacro arguments (" + told(plan.xacro) +
                  ") than those of the robot that is checked (" + told(robot.xacro) + ")");
}

/// The joints that --fix holds, by value or by a state.
std::set<std::string> held_by_flags(const CheckOptions& options, const std::string& group) {
  RobotRequest request = robot_request(options.robot);
  std::set<std::string> names;
  for (const auto& [name, value] : request.fixed) names.insert(name);
  if (request.fixed_states.empty()) return names;
  request.group = group;
  request.standing.clear();
  for (const HeldJoint& joint : load_robot(request).held)
    if (joint.source == HoldSource::asked) names.insert(joint.name);
  return names;
}

TermSource source_of(const HeldJoint& joint, const Plan& plan, const std::set<std::string>& by_flags) {
  if (joint.source != HoldSource::asked) return TermSource::by_default;
  return by_flags.contains(joint.name) || !plan.held.contains(joint.name) ? TermSource::flag
                                                                          : TermSource::plan;
}

}  // namespace

void require_same_joints(const Robot& robot, const Plan& plan, const std::filesystem::path& file) {
  const std::vector<std::string> own = joint_names(robot);
  if (own == plan.joints) return;
  const auto other = std::find_if(plan.joints.begin(), plan.joints.end(), [&](const std::string& name) {
    return std::find(own.begin(), own.end(), name) == own.end();
  });
  throw std::invalid_argument(file.string() + ": field 'joints': the plan is for " +
                              std::to_string(plan.joints.size()) + " joints that are not those of robot " +
                              quote(robot.name) + " (" + counted(robot.dof(), "joint") + ")" +
                              (other == plan.joints.end() ? "" : ", of which none is " + quote(*other)));
}

Robot robot_to_check(const CheckOptions& options, const Plan& plan) {
  RobotRequest request = robot_request(options.robot);
  if (plan.held.empty()) return load_robot(request);
  const std::vector<std::string> standing =
      std::exchange(request.standing, {});  // by what the plan holds, too
  Robot robot = load_robot(request);
  const bool is_stated =
      !request.group.empty() || !robot.group.empty();  // by flag, or by the robot's settings
  const auto is_free_to_stand = [&](const std::string& name) {
    for (const HeldJoint& joint : robot.held) {
      if (joint.name != name) continue;
      return joint.source == HoldSource::zero || joint.source == HoldSource::default_state;
    }
    return !is_stated;  // a joint that moves by the user's own word is not held by the plan's
  };
  if (!is_stated) request.group = plan.group;
  if (request.group != robot.group) robot = load_robot(request);
  for (const auto& [name, value] : plan.held)
    if (is_free_to_stand(name)) request.fixed[name] = value;
  request.standing = standing;
  return load_robot(request);
}

void state_robot(const CheckOptions& options, const Plan& plan, const Robot& robot, Contract& contract) {
  contract.robot = {options.robot.robot, TermSource::flag};
  contract.group = group_of(options, robot);
  const std::set<std::string> by_flags = held_by_flags(options, robot.group);
  for (const HeldJoint& joint : robot.held)
    contract.held[joint.name] = {joint.value, source_of(joint, plan, by_flags)};
  note_held(options, contract, robot, contract.notes);
  note_xacro(robot, plan, contract.notes);
}

}  // namespace clearway
