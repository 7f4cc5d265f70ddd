#pragma once

#include "planning/files/plan_file.hpp"
#include "planning/path/smooth_motion.hpp"
#include "planning/path/trajectory.hpp"

namespace clearway {

/// The smooth motion along a proved plan, re-checked by check_motion under the plan's own terms. Where the
/// check does not follow our proof, blends are made shorter, and at last the motion stops at each waypoint.
/// Whoever drives a robot asks PlannedMotion::validation first.
/// @param space the plan's own: robot, map, policies and padding
/// @throws std::invalid_argument for a plan that is not proved, and as smooth_motion and check_motion.
PlannedMotion plan_motion(const ConfigurationSpace& space, const Plan& plan,
                          const SmoothMotionOptions& options = {});

/// The same motion as points in time, one at each knot, with accelerations.
Trajectory trajectory_of(const Motion& motion);

}  // namespace clearway
