#include "planning/pose_goals.hpp"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <numbers>
#include <random>
#include <stdexcept>
#include <utility>

#include "mapping/system/number_text.hpp"
#include "mapping/system/plain_text.hpp"
#include "mapping/system/random_unit.hpp"
#include "mapping/system/thread_time.hpp"
#include "mapping/voxels/rigid_pose.hpp"
#include "planning/files/query_record.hpp"
#include "planning/robot/kinematics.hpp"
#include "planning/robot_files/srdf_file.hpp"
#include "planning/robot_files/tip_choice.hpp"

namespace clearway {
namespace {

constexpr std::size_t most_choices = 16;  ///< of one goal
constexpr int starts_of_variant = 8;      ///< of inverse kinematics, for poses that are not the goal itself
constexpr int starts_of_last_try = 2000;  ///< where none that was found is free
constexpr int tries_aside = 32;           ///< places of joints that do not move the tip

void require_sound(const NamedGoalPose& goal) {
  const auto refuse = [&](const std::string& what) {
    throw std::invalid_argument("goal pose " + quote(goal.name) + ": " + what);
  };
  const GoalPose& pose = goal.pose;
  if (!pose.map_from_tip.matrix().allFinite() || !is_rotation(pose.map_from_tip.linear()))
    refuse("map_from_tip is no rigid pose, expected finite numbers and a rotation without scale or mirror");
  if (!std::isfinite(pose.position_tolerance) || pose.position_tolerance < 0.0)
    refuse("position_tolerance is " + short_text(pose.position_tolerance) + ", expected metres not below 0");
  if (!(pose.turn_tolerance >= 0.0 && pose.turn_tolerance <= std::numbers::pi * (1.0 + 1e-12)))
    refuse("turn_tolerance is " + short_text(pose.turn_tolerance) + ", expected 0 to pi");
  if (pose.free_axis && (*pose.free_axis < 0 || *pose.free_axis > 2))
    refuse("free_axis is " + std::to_string(*pose.free_axis) + ", expected 0, 1 or 2");
}

}  // namespace

PoseGoals::PoseGoals(const ConfigurationSpace& space, const std::string& tip,
                     std::vector<NamedGoalPose> poses, Configuration start)
    : space_(space),
      robot_(tip.empty() ? space.robot() : with_tip(space.robot(), link_of_tip(space.robot(), tip))),
      poses_(std::move(poses)),
      start_(std::move(start)) {
  require_one_tip(robot_);
  require_configuration(robot_, start_, "pose goals: start");
  for (const NamedGoalPose& pose : poses_) require_sound(pose);
  choose_from(0);
}

std::vector<Configuration> PoseGoals::goals() const {
  std::vector<Configuration> goals;
  for (const Choices& choices : choices_) goals.push_back(choices.configurations[choices.at]);
  return goals;
}

bool PoseGoals::has_next(std::size_t goal) const { return choices_[goal].at + 1 < choices_[goal].free; }

bool PoseGoals::choose_next(std::size_t goal) {
  if (!has_next(goal)) return false;
  ++choices_[goal].at;
  choose_from(goal + 1);
  return true;
}

std::size_t PoseGoals::blocked_at(std::size_t goal) const {
  if (goal >= choices_.size() || choices_[goal].free > 0) return 0;
  return choices_[goal].configurations.size();
}

void PoseGoals::choose_from(std::size_t goal) {
  choices_.resize(goal);
  for (; goal < poses_.size(); ++goal) choices_.push_back(choices_of(goal));
}

PoseGoals::Choices PoseGoals::choices_of(std::size_t goal) const {
  const GoalPose& wanted = poses_[goal].pose;
  const Configuration near = goal == 0 ? start_ : choices_[goal - 1].configurations[choices_[goal - 1].at];
  const std::vector<Eigen::Isometry3d> poses = poses_of(wanted);
  const GoalPose in_place{wanted.map_from_tip, 0.0, 0.0, wanted.free_axis};
  const std::size_t exact = poses_of(in_place).size();
  Choices choices;
  std::vector<Configuration> blocked;
  const auto take = [&](const std::vector<Configuration>& found) {
    for (const Configuration& q : found) {
      if (!space_.is_free(q)) {
        blocked.push_back(q);
      } else if (choices.free < most_choices) {
        choices.configurations.push_back(q);
        ++choices.free;
      }
    }
  };
  take(goal_configurations(robot_, poses[0], near));
  for (std::size_t i = 1; i < poses.size() && choices.free < most_choices; ++i) {
    if (i == exact) {  // elsewhere is for goals that cannot be reached exactly
      if (choices.free == 0 && wanted.free_axis) take(goal_configurations(robot_, in_place, near));
      if (choices.free > 0) break;
    }
    take(goal_configurations(robot_, poses[i], near, starts_of_variant));
  }
  // Poses drawn from the goal miss what an arm of few joints reaches of it.
  if (choices.free == 0 && !wanted.is_exact()) take(goal_configurations(robot_, wanted, near));
  if (choices.free == 0 && !blocked.empty() && exact == 1) {  // all branches of them
    std::vector<Configuration> before = std::exchange(blocked, {});
    take(goal_configurations(robot_, poses[0], near, starts_of_last_try));
    if (blocked.empty()) blocked = std::move(before);
  }
  if (choices.free == 0 && !blocked.empty()) {  // another arm may be in the way
    for (const Configuration& aside : with_others_aside(near)) {
      if (choices.free > 0) break;
      take(goal_configurations(robot_, poses[0], aside, starts_of_variant));
    }
  }
  const auto is_nearer = [&](const Configuration& a, const Configuration& b) {
    return largest_difference(a, near) < largest_difference(b, near);
  };
  std::stable_sort(choices.configurations.begin(), choices.configurations.end(), is_nearer);
  std::stable_sort(blocked.begin(), blocked.end(), is_nearer);
  if (choices.free == 0) choices.configurations = std::move(blocked);
  if (choices.configurations.empty())
    throw UnreachablePose(poses_[goal].name + ": no configuration of robot " + quote(robot_.name) +
                          " within its limits was found that puts link " +
                          quote(robot_.links[static_cast<std::size_t>(robot_.tip_link)].name) +
                          " there, expected a pose within reach" + hint_of(wanted));
  return choices;
}

/// With joints that do not move the tip at other values: none where all do.
std::vector<Configuration> PoseGoals::with_others_aside(const Configuration& near) const {
  std::vector<bool> moves(robot_.dof(), false);
  for (int link = robot_.tip_link; link >= 0; link = robot_.links[static_cast<std::size_t>(link)].parent)
    if (const int joint = robot_.links[static_cast<std::size_t>(link)].joint; joint >= 0)
      moves[static_cast<std::size_t>(joint)] = true;
  int last = robot_.tip_link;  // what moves on it, as fingers do, is at the tip and stays
  while (last >= 0 && robot_.links[static_cast<std::size_t>(last)].joint < 0)
    last = robot_.links[static_cast<std::size_t>(last)].parent;
  for (std::size_t i = 0; i < robot_.links.size(); ++i) {
    if (robot_.links[i].joint < 0 || moves[static_cast<std::size_t>(robot_.links[i].joint)]) continue;
    for (int above = static_cast<int>(i); above >= 0;
         above = robot_.links[static_cast<std::size_t>(above)].parent)
      if (above == last) moves[static_cast<std::size_t>(robot_.links[i].joint)] = true;
  }
  std::vector<Configuration> found;
  if (std::find(moves.begin(), moves.end(), false) == moves.end()) return found;
  std::mt19937_64 random(1);
  for (int i = 1; i <= tries_aside; ++i) {
    Configuration q = near;
    for (std::size_t j = 0; j < robot_.dof(); ++j) {
      if (moves[j]) continue;
      const Joint& joint = robot_.joints[j];
      const bool has_ends = std::isfinite(joint.upper - joint.lower);
      const double lower = has_ends ? joint.lower : -std::numbers::pi,
                   upper = has_ends ? joint.upper : std::numbers::pi;
      const auto at = static_cast<Eigen::Index>(j);
      const double reach = static_cast<double>(i) / tries_aside;  // farther from where it is each time
      q[at] += reach * (lower + random_unit(random) * (upper - lower) - q[at]);
    }
    found.push_back(std::move(q));
  }
  return found;
}

std::string PoseGoals::hint_of(const GoalPose& wanted) const {
  const std::size_t joints = joints_of_tip(robot_);
  if (joints >= 6 || !wanted.is_exact()) return {};
  return "; an arm of " + counted(joints, "joint") +
         " reaches few poses exactly: leave a turn open (free axis, turn tolerance)";
}

namespace {

/// @param has_untried whether the clock ended the search, not the choices
void tell_of_others(std::vector<PlanResult>& legs, int others, bool has_untried, double time_limit) {
  if (legs.empty()) return;
  PlanResult& leg = legs.back();
  if (others > 0)
    leg.explanation += " " + std::to_string(others) + " other configuration" + (others == 1 ? "" : "s") +
                       " at the goal's pose did no better.";
  if (!has_untried) return;
  leg.explanation += " Configurations at the goal's pose were left untried at the time limit of " +
                     short_text(time_limit) + " s (--time-limit gives more).";
  if (leg.status == PlanStatus::no_path) leg.status = PlanStatus::timed_out;
}

Plan plan_to_choices(PlanQuery query, PoseGoals& goals) {
  const auto begin = std::chrono::steady_clock::now();
  query.goals = goals.goals();
  Plan first = plan_and_check(query);
  Plan plan = first;
  if (first.status() == PlanStatus::start_invalid && first.legs.size() == 1) return first;
  if (const std::size_t blocked = first.legs.empty() ? 0 : goals.blocked_at(first.legs.size() - 1);
      blocked > 1 && first.status() == PlanStatus::goal_invalid)
    first.legs.back().explanation += " Of " + counted(blocked, "configuration") +
                                     " that were found at its pose none is free; this is the "
                                     "nearest.";
  query.advice_time = 0.0;
  int others = 0;
  while (plan.status() != PlanStatus::solved) {
    const bool is_out_of_time = seconds_since(begin) > query.time_limit;
    const bool has_next = !plan.legs.empty() && goals.has_next(plan.legs.size() - 1);
    if (is_out_of_time || !has_next) {
      tell_of_others(first.legs, others, has_next, query.time_limit);
      return first;
    }
    goals.choose_next(plan.legs.size() - 1);
    query.goals = goals.goals();
    plan = plan_and_check(query);
    ++others;
  }
  return plan;
}

}  // namespace

Plan plan_to_poses(PlanQuery query, PoseGoals goals) {
  Plan plan = plan_to_choices(std::move(query), goals);
  plan.tip = tip_name(goals.robot());
  return plan;
}

Plan plan_out_of_reach(PlanQuery query, std::size_t goals, const UnreachablePose& why) {
  query.goals.assign(goals, query.start);  // of which loads count their legs
  Plan plan = empty_plan(query, *query.planner);
  plan.goals.clear();
  PlanResult refused;
  refused.status = PlanStatus::goal_invalid;
  refused.explanation = std::string("The goal is out of reach: ") + why.what() + ".";
  plan.legs.push_back(std::move(refused));
  return plan;
}

}  // namespace clearway
