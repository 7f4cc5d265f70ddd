#pragma once

#include <string>
#include <vector>

#include "apps/console/commands.hpp"
#include "planning/pose_goals.hpp"

namespace clearway {

/// What --goal-pose and the flags that go with it ask for, each named as it was given; none without it.
/// @param has_goals whether --goal was given, too @param has_pick whether --pick was, whose grasp is the
/// tip's
/// @throws std::invalid_argument for flags that do not go with one another or lack --goal-pose (or --pick),
/// for numbers
///         that are no pose, and for a tip that the robot does not have.
std::vector<NamedGoalPose> choose_goal_poses(const GoalPoseChoice& choice, bool has_goals, bool has_pick,
                                             const Robot& robot);

/// The robot with its tip at this link or end effector of the SRDF; empty: at its own.
/// @throws std::invalid_argument when it has none of that name.
Robot with_tip_of(const Robot& robot, const std::string& tip);

/// "link hand", or "own tip on hand", for what `tip_name` says; cut where it is long.
std::string describe_tip(const std::string& name);

/// "link 'hand' at (0.4, 0, 0.3, 3.14, 0, 0), within 5 mm, within 0.1 rad, turned freely about z".
/// @param tip link that the pose places; empty: "the tip at …"
std::string describe_goal_pose(const std::string& tip, const GoalPose& goal);

}  // namespace clearway
