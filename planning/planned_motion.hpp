#pragma once

#include <map>
#include <optional>
#include <string>
#include <vector>

#include "planning/check/motion_torques.hpp"
#include "planning/files/plan_file.hpp"
#include "planning/path/smooth_motion.hpp"
#include "planning/path/trajectory.hpp"

namespace clearway {

/// The smooth motion along a proved plan, re-checked under the plan's own terms. Where the check does not
/// follow our proof, blends are made shorter, and at last the motion stops at each waypoint. Torque limits
/// (torque_terms) are kept with the plan's payload, gravity and loads, and judged by KDL. Whoever drives a
/// robot asks PlannedMotion::validation first.
/// With loads or a pick each leg is proved with the robot and voxels that its path was planned with
/// (LegMotions); where a load begins or ends to ride between two legs the robot rests for `grip_time` seconds
/// for each, in whole periods. Of a pick the blends of the one leg that the check refuses are shortened.
/// @param space the plan's own, of the robot without loads: map, policies and padding
/// @throws std::invalid_argument for a plan that is not proved, a grip_time outside 0 to 60 s, and as
/// smooth_motion and check_motion.
PlannedMotion plan_motion(const ConfigurationSpace& space, const Plan& plan,
                          const SmoothMotionOptions& options = {}, double grip_time = usual_grip_time);

/// Gives a proved plan its motion (plan_motion), or Plan::motion_caveat: its motion would be too long, or the
/// check refuses it. A plan that is not proved is left as it is.
void give_motion(const ConfigurationSpace& space, Plan& plan, const SmoothMotionOptions& options = {},
                 double grip_time = usual_grip_time);

/// What a motion is judged under.
struct MotionTerms {
  const Robot& robot;  ///< without loads, at its place and scale
  const Snapshot& map;
  std::map<std::string, Policy> policies;  ///< of every part, loads included
  double padding = 0.0, seen_within = 0.0;
  JointLoad load{};  ///< at the robot's scale, beside the loads
};

/// What the independent check finds of a motion.
struct MotionJudgement {
  MotionVerdict verdict;
  std::optional<TorqueFinding> torques;  ///< where the motion is valid but for them
};

/// The verdict on a plan's motion, whatever the plan says of it: by check_motion or check_pick_motion, with
/// the limits of the robot's own files, scaled as the motion states; then torques, of each leg with the loads
/// that ride on it. Its shares are of the limits before they are scaled.
/// @param plan with the loads and the pick that are stated, not its own; where a picked object rides is the
/// plan's @pre plan.motion, and its path was found valid under the same terms
MotionJudgement judge_motion(const MotionTerms& terms, const Plan& plan);

/// judge_motion in the space and under its terms, with the plan's payload and gravity.
/// @param policies of every part, loads included
MotionVerdict check_planned_motion(const ConfigurationSpace& space, const Plan& plan,
                                   const std::map<std::string, Policy>& policies);

/// What the plan carries at the tip, at the robot's scale.
JointLoad load_of(const Plan& plan, const Robot& robot);

/// A motion as points in time, one at each knot, with accelerations.
Trajectory trajectory_of(const Motion& motion);

/// A proved plan in time: its motion; where it has none, its edges without blends (time_parameterize), of a
/// plan with loads leg by leg, at rest where legs end. Where a load begins or ends to ride on the robot
/// between two legs, the arm rests, in whole sampling periods, and an event says so: for as long as the
/// motion states, else for `grip_time` seconds.
/// @throws std::invalid_argument as time_parameterize, and for a motion that does not state where each leg
/// ends
Trajectory trajectory_of(const Robot& robot, const Plan& plan, double grip_time = usual_grip_time);

/// The same leg by leg, each from 0 s on; the first points of the next leg are the rest after it.
/// @throws std::invalid_argument as time_parameterize, and for a motion that does not state where each leg
/// ends
std::vector<Trajectory> leg_trajectories(const Robot& robot, const Plan& plan);

}  // namespace clearway
