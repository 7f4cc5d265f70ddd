#pragma once

#include <stdexcept>
#include <string>
#include <vector>

#include "planning/plan_and_check.hpp"
#include "planning/robot/goal_configurations.hpp"

namespace clearway {

/// A goal that is a pose, and what sentences call it: "--goal-pose 0.4,0,0.3".
struct NamedGoalPose {
  GoalPose pose;
  std::string name;
};

/// No configuration was found at a pose, which the sentence names.
class UnreachablePose : public std::invalid_argument {
 public:
  using std::invalid_argument::invalid_argument;
};

/// Goals that are poses of a link, as configurations. Of each pose those count that inverse kinematics finds,
/// exactly there or within what the pose leaves open (poses_of). Free ones come before others, those nearest
/// to the goal before (the first: to the start) come first, and what is exact, or turned about its free axis,
/// comes before what is elsewhere within its tolerances.
class PoseGoals {
 public:
  /// @param space must live as long
  /// @param tip link, or end effector of the SRDF, that the poses are of; empty: the robot's own tip
  /// @throws UnreachablePose when no configuration is at one; std::invalid_argument naming the pose when it
  /// is not rigid or one of its tolerances is out of range, or naming the tip, or what it could be
  /// (require_one_tip)
  PoseGoals(const ConfigurationSpace& space, const std::string& tip, std::vector<NamedGoalPose> poses,
            Configuration start);

  /// The robot with the tip that the poses are of.
  const Robot& robot() const { return robot_; }

  /// The choice of each goal: at first the best one.
  std::vector<Configuration> goals() const;

  bool has_next(std::size_t goal) const;  ///< another free one for this goal

  /// Chooses the next one for this goal, and the best for those after it; false when it has no other free
  /// one.
  bool choose_next(std::size_t goal);

  /// How many configurations were found at a goal of which none is free; 0: one is.
  std::size_t blocked_at(std::size_t goal) const;

 private:
  struct Choices {
    std::vector<Configuration> configurations;
    std::size_t free = 0;  ///< how many, at their beginning
    std::size_t at = 0;
  };
  Choices choices_of(std::size_t goal) const;
  void choose_from(std::size_t goal);
  std::vector<Configuration> with_others_aside(const Configuration& near) const;
  std::string hint_of(const GoalPose& wanted) const;  ///< empty: none

  const ConfigurationSpace& space_;
  Robot robot_;
  std::vector<NamedGoalPose> poses_;
  Configuration start_;
  std::vector<Choices> choices_;
};

/// As plan_and_check, with `goals` in place of the query's own. A goal that cannot be reached is tried at its
/// next configuration, while the time of all tries is below the query's limit; then the first try is the
/// answer, and says how many others were tried, and whether the time ended before all were. The plan's goals
/// are those that it was made for, and its tip is theirs.
/// @throws std::invalid_argument as plan_and_check
Plan plan_to_poses(PlanQuery query, PoseGoals goals);

/// The answer where a goal is out of reach: goal_invalid, and why. @param goals how many were asked for
Plan plan_out_of_reach(PlanQuery query, std::size_t goals, const UnreachablePose& why);

}  // namespace clearway
