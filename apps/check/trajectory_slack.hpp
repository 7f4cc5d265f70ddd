#pragma once

#include <vector>

#include "apps/check/trajectory_file.hpp"
#include "planning/robot/robot.hpp"

namespace clearway {

/// How far bodies may be from where they are judged, in metres: joints that stand still or follow another
/// (mimic), and the base, are judged where the robot's files and the contract put them, joints at a limit
/// there, and trajectories may have them a little beside (plan_of_trajectory, require_base, draw_to_limits).
/// The joints' differences times the reach of what hangs on them, added up; what velocities and accelerations
/// make of a joint between two points, too. An upper bound.
/// @param map_from_base where the base is judged
/// @pre each trajectory passed plan_of_trajectory and require_base
double slack_of(const std::vector<ForeignTrajectory>& trajectories, const Robot& robot,
                const Eigen::Isometry3d& map_from_base);

}  // namespace clearway
