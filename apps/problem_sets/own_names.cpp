#include "apps/problem_sets/own_names.hpp"

#include <algorithm>
#include <optional>
#include <set>
#include <stdexcept>
#include <string_view>

#include "mapping/system/plain_text.hpp"

namespace clearway {
namespace {

using Names = std::set<std::string>;

/// What stands before an own name in a name that ends with it, up to a '_'; none where it does not.
std::optional<std::string_view> prefix_of(std::string_view name, const std::string& own) {
  if (!name.ends_with(own)) return std::nullopt;
  name.remove_suffix(own.size());
  if (name.empty() || name.ends_with('_')) return name;
  return std::nullopt;
}

/// @param beside other names; one whose prefix begins this name's prefix is more likely meant: beside
/// panda_joint1, panda_finger_joint1 is no joint1
template <typename Named>
std::string own_name(const std::vector<Named>& own, const std::string& name, const Names& beside) {
  std::string found;
  for (const Named& named : own) {
    if (named.name == name) return name;
    if (prefix_of(name, named.name) && named.name.size() > found.size()) found = named.name;
  }
  if (found.empty()) return name;
  const std::string_view prefix = *prefix_of(name, found);
  const bool is_another = std::any_of(beside.begin(), beside.end(), [&](const std::string& other) {
    const auto shorter = prefix_of(other, found);
    return shorter && *shorter != prefix && prefix.starts_with(*shorter);
  });
  return is_another ? name : found;
}

/// Names that the robot does not have.
template <typename Named>
Names foreign(const std::vector<Named>& own, Names names) {
  for (const Named& named : own) names.erase(named.name);
  return names;
}

void add_joints(const ForeignState& state, Names& names) {
  for (const auto& [joint, value] : state.by_joint) names.insert(joint);
}

ForeignState with_own_names(const Robot& robot, const ForeignState& state, Names beside) {
  ForeignState own{{}, state.values};
  add_joints(state, beside);
  for (const auto& [joint, value] : state.by_joint) {
    const std::string name = own_name(robot.joints, joint, beside);
    if (!own.by_joint.emplace(name, value).second)
      throw std::invalid_argument("joint " + quote(joint) + " and another one both stand for joint " +
                                  quote(name) + " of robot " + quote(robot.name) +
                                  ", expected one name for each");
  }
  return own;
}

Names joints_of(const ForeignProblem& problem) {
  Names names;
  add_joints(problem.start, names);
  for (const ForeignGoal& goal : problem.goals) add_joints(goal.joints, names);
  return names;
}

Names links_of(const ForeignProblem& problem) {
  Names names;
  for (const ForeignGoal& goal : problem.goals)
    if (goal.pose) names.insert(goal.pose->link);
  for (const ForeignAttached& body : problem.attached) {
    names.insert({body.link, body.frame});
    names.insert(body.touches.begin(), body.touches.end());
  }
  return names;
}

}  // namespace

ForeignProblem with_names_of(const Robot& robot, const ForeignProblem& problem) {
  ForeignProblem own = problem;
  const Names joints = foreign(robot.joints, joints_of(problem));
  const Names links = foreign(robot.links, links_of(problem));
  const auto rename = [&](std::string& link) { link = own_name(robot.links, link, links); };
  own.start = with_own_names(robot, problem.start, joints);
  for (ForeignGoal& goal : own.goals) {
    Names beside = joints;
    add_joints(goal.joints, beside);
    for (JointBand& band : goal.bands) band.joint = own_name(robot.joints, band.joint, beside);
    goal.joints = with_own_names(robot, goal.joints, joints);
    if (goal.pose) rename(goal.pose->link);
  }
  for (ForeignAttached& body : own.attached) {
    rename(body.link);
    rename(body.frame);
    for (std::string& link : body.touches) rename(link);
  }
  return own;
}

OwnJoints own_joints(const Robot& robot, const std::map<std::string, double>& joints) {
  Names beside;
  for (const auto& [joint, value] : joints) beside.insert(joint);
  beside = foreign(robot.joints, beside);
  OwnJoints own;
  Names twice;
  for (const auto& [joint, value] : joints) {
    const std::string name = own_name(robot.joints, joint, beside);
    if (!own.values.emplace(name, value).second) twice.insert(name);
    if (name != joint) own.prefixes.insert(joint.substr(0, joint.size() - name.size()));
  }
  for (const std::string& name : twice) own.values.erase(name);
  if (!twice.empty()) own.prefixes.clear();
  return own;
}

}  // namespace clearway
