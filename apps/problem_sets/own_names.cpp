#include "apps/problem_sets/own_names.hpp"

#include <stdexcept>

#include "mapping/system/plain_text.hpp"

namespace clearway {
namespace {

template <typename Named>
std::string own_name(const std::vector<Named>& own, const std::string& name) {
  std::string found = name;
  int longer = 0;
  for (const Named& named : own) {
    if (named.name == name) return name;
    if (!name.ends_with("_" + named.name)) continue;
    found = named.name;
    ++longer;
  }
  return longer == 1 ? found : name;
}

ForeignState with_own_names(const Robot& robot, const ForeignState& state) {
  ForeignState own{{}, state.values};
  for (const auto& [joint, value] : state.by_joint)
    if (!own.by_joint.emplace(own_name(robot.joints, joint), value).second)
      throw std::invalid_argument("joint " + quote(joint) + " and another one both stand for joint " +
                                  quote(own_name(robot.joints, joint)) + " of robot " + quote(robot.name) +
                                  ", expected one name for each");
  return own;
}

}  // namespace

ForeignProblem with_names_of(const Robot& robot, const ForeignProblem& problem) {
  ForeignProblem own = problem;
  own.start = with_own_names(robot, problem.start);
  for (ForeignGoal& goal : own.goals) {
    goal.joints = with_own_names(robot, goal.joints);
    if (goal.pose) goal.pose->link = own_name(robot.links, goal.pose->link);
  }
  for (ForeignAttached& body : own.attached) {
    body.link = own_name(robot.links, body.link);
    body.frame = own_name(robot.links, body.frame);
    for (std::string& link : body.touches) link = own_name(robot.links, link);
  }
  return own;
}

}  // namespace clearway
