#pragma once

#include "planning/plan_and_check.hpp"
#include "planning/problem/pick.hpp"

namespace clearway {

/// Plans the legs of a pick and place (Pick), has the independent check prove them (check_pick), and surveys
/// what the map knows of where the robot goes. `query.space` is of the robot without loads in the map with
/// the object; `query.goals` is empty, or one configuration to leave to afterwards; `query.loads` is empty.
/// `time_limit` is of the whole plan.
///
/// Grasps are all configurations that inverse kinematics finds for the tip at the object, nearest to the
/// start first, of axial objects in twelve turns about the axis; those count from which the straight legs are
/// free. The planner joins the first such grasp and place that it can. The legs of the plan are those of
/// names_of_legs(); the first one that fails ends it and says why.
/// @throws std::invalid_argument as plan_and_check, and for a pick that is not sound or that the robot cannot
///         hold: a joint moves the link that carries the object against the tip.
Plan plan_pick(const PlanQuery& query, const Pick& pick);

/// The object rides on one link, and the tip takes and places it.
/// @throws std::invalid_argument in one sentence where a joint moves these against each other.
void require_rigid_hold(const Robot& robot, const Pick& pick);

}  // namespace clearway
