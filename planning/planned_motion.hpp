#pragma once

#include "planning/files/plan_file.hpp"
#include "planning/path/smooth_motion.hpp"
#include "planning/path/trajectory.hpp"

namespace clearway {

/// The smooth motion along a proved plan, re-checked by check_motion under the plan's own terms. Where the
/// check does not follow our proof, blends are made shorter, and at last the motion stops at each waypoint.
/// Torque limits (torque_terms) are kept with the plan's payload and gravity, and judged by KDL. Whoever
/// drives a robot asks PlannedMotion::validation first.
/// @param space the plan's own: robot, map, policies and padding
/// @throws std::invalid_argument for a plan that is not proved or carries loads, and as smooth_motion and
/// check_motion.
PlannedMotion plan_motion(const ConfigurationSpace& space, const Plan& plan,
                          const SmoothMotionOptions& options = {});

/// Gives a proved plan its motion (plan_motion), or Plan::motion_caveat: it carries loads, its motion would
/// be too long, or the check refuses it. A plan that is not proved is left as it is.
void give_motion(const ConfigurationSpace& space, Plan& plan, const SmoothMotionOptions& options = {});

/// The verdict on a plan's motion, whatever the plan says of it: by check_motion in the space and under its
/// terms, with the limits of the robot's own files, torques (torque_fault) with the plan's payload and
/// gravity. Motions of robots that carry loads are not checked, which is a fault.
/// @pre plan.motion
MotionVerdict check_planned_motion(const ConfigurationSpace& space, const Plan& plan);

/// What the plan was told to carry, at the robot's scale.
JointLoad load_of(const Plan& plan, const Robot& robot);

/// A motion as points in time, one at each knot, with accelerations.
Trajectory trajectory_of(const Motion& motion);

/// A proved plan in time: its motion; where it has none, its edges without blends (time_parameterize), of a
/// plan with loads leg by leg, at rest where legs end. Where a load begins or ends to ride on the robot
/// between two legs, the arm rests for `grip_time` seconds, in whole sampling periods, and an event says so.
/// @throws std::invalid_argument as time_parameterize
Trajectory trajectory_of(const Robot& robot, const Plan& plan, double grip_time = usual_grip_time);

}  // namespace clearway
