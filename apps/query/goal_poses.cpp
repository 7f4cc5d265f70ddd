#include "apps/query/goal_poses.hpp"

#include <algorithm>
#include <numbers>
#include <stdexcept>
#include <utility>

#include "apps/console/parse.hpp"
#include "mapping/system/plain_text.hpp"
#include "planning/robot_files/srdf_file.hpp"
#include "planning/robot_files/tip_choice.hpp"

namespace clearway {

Robot with_tip_of(const Robot& robot, const std::string& tip) {
  return tip.empty() ? robot : with_tip(robot, link_of_tip(robot, tip));
}

std::string describe_tip(const std::string& name) {
  return (is_own_tip_name(name) ? "" : "link ") + shortened(name);
}

std::vector<NamedGoalPose> choose_goal_poses(const GoalPoseChoice& choice, bool has_goals, bool has_pick,
                                             const Robot& robot) {
  if (has_goals && !choice.poses.empty())
    throw std::invalid_argument("--goal-pose: expected either --goal or --goal-pose, got both");
  if (!choice.tip.empty() && choice.poses.empty() && !has_pick)
    throw std::invalid_argument("--tip: expected --goal-pose or --pick with it");
  for (const auto& [is_given, flag] : {std::pair{choice.position_tolerance > 0.0, "--position-tolerance"},
                                       std::pair{choice.turn_tolerance > 0.0, "--turn-tolerance"},
                                       std::pair{!choice.free_axis.empty(), "--free-axis"}})
    if (is_given && choice.poses.empty())
      throw std::invalid_argument(std::string(flag) + ": expected --goal-pose with it");
  with_tip_of(robot, choice.tip);
  std::vector<NamedGoalPose> poses;
  for (const std::string& text : choice.poses) {
    GoalPose pose{pose_from_numbers(parse_numbers(text, "--goal-pose"), "--goal-pose"),
                  choice.position_tolerance, std::min(choice.turn_tolerance, std::numbers::pi)};
    if (!choice.free_axis.empty()) pose.free_axis = choice.free_axis.front() - 'x';
    poses.push_back({pose, "--goal-pose " + text});
  }
  return poses;
}

std::string describe_goal_pose(const std::string& tip, const GoalPose& goal) {
  std::string text = (tip.empty() ? "the tip" : "link " + quote(tip)) + " at " + to_text(goal.map_from_tip);
  if (goal.position_tolerance > 0.0)
    text += ", within " + significant(1000.0 * goal.position_tolerance) + " mm";
  if (goal.turn_tolerance > 0.0) text += ", within " + significant(goal.turn_tolerance) + " rad";
  if (goal.free_axis) text += std::string(", turned freely about ") + "xyz"[*goal.free_axis];
  return text;
}

}  // namespace clearway
