#include "apps/problem_sets/goal_choice.hpp"

#include <optional>
#include <stdexcept>

#include "apps/query/loads.hpp"
#include "mapping/system/plain_text.hpp"
#include "planning/pose_goals.hpp"
#include "planning/space/configuration_space.hpp"

namespace clearway {
namespace {

ConfigurationSpace space_of(const GoalQuestion& question, const Robot& robot, const Snapshot& map,
                            double padding) {
  return {with_all_loads(robot, question.loads),
          map,
          Policies{{}, Policy::not_occupied, false},
          {.padding = padding}};
}

/// The robot with the point of the link that the goal places as its tip.
Robot with_point_as_tip(const Robot& robot, const ForeignPose& pose) {
  const bool is_its_own = robot.links[static_cast<std::size_t>(robot.tip_link)].name == pose.link &&
                          pose.point.isZero(0.0) &&
                          robot.link_from_tip.isApprox(Eigen::Isometry3d::Identity());
  if (is_its_own) return robot;
  Robot placed = with_tip(robot, pose.link);
  placed.link_from_tip.translation() = pose.point;
  return placed;
}

}  // namespace

std::vector<std::string> joints_above(const Robot& robot, const std::string& link) {
  std::vector<std::string> joints;
  int at = with_tip(robot, link).tip_link;  // refuses what is none
  for (; at >= 0; at = robot.links[static_cast<std::size_t>(at)].parent) {
    const int joint = robot.links[static_cast<std::size_t>(at)].joint;
    if (joint >= 0) joints.push_back(robot.joints[static_cast<std::size_t>(joint)].name);
  }
  return joints;
}

GoalChoice choose_goal(const GoalQuestion& question, const Robot& robot, const Snapshot& map,
                       double padding) {
  std::optional<GoalChoice> blocked;
  std::string refusal;
  for (std::size_t i = 0; i < question.goals.size(); ++i) {
    const ForeignGoal& goal = question.goals[i];
    const Robot placed = goal.pose ? with_point_as_tip(robot, *goal.pose) : robot;
    const ConfigurationSpace space = space_of(question, placed, map, padding);
    GoalChoice choice;
    choice.goal = i;
    try {
      choice.q = goal.pose ? PoseGoals(space, "", {{goal.pose->pose, "its goal"}}, question.start).goals()[0]
                           : Eigen::Map<const Configuration>(goal.joints.values.data(),
                                                             static_cast<Eigen::Index>(robot.dof()));
    } catch (const std::invalid_argument& error) {
      if (refusal.empty()) refusal = error.what();
      continue;
    }
    choice.is_free = space.is_free(choice.q);
    if (choice.is_free) return choice;
    if (!blocked) blocked = choice;
  }
  if (!blocked) throw std::invalid_argument("problem " + quote(question.name) + ": " + refusal);
  return *blocked;
}

}  // namespace clearway
