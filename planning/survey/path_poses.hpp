#pragma once

#include <Eigen/Geometry>
#include <functional>
#include <vector>

#include "planning/robot/kinematics.hpp"
#include "planning/robot/robot.hpp"

namespace clearway {

namespace check {
class KdlArm;
}

/// The robot as it was loaded, with no file that the check's kinematics would read again: that the two agree
/// is for check_path to say.
Robot without_file(Robot robot);

/// A place on a path: `parameter` of the way along the straight edge that starts at waypoint `edge`.
struct PathPlace {
  int edge = 0;
  double parameter = 0.0;
};

/// Calls `visit(map_from_shape, place)` for poses of one body along a path, its first and last waypoint among
/// them, such that no point of the body moves farther than `spacing` from one to the next. So whatever the
/// body covers at any time is within half of that of what it covers at one of the poses. Precondition: every
/// waypoint has as many values as the robot has joints, all finite.
/// @throws std::invalid_argument when that takes more than a million poses.
void visit_body_poses(const check::KdlArm& arm, std::size_t body, const std::vector<Configuration>& path,
                      double spacing,
                      const std::function<void(const Eigen::Isometry3d&, const PathPlace&)>& visit);

}  // namespace clearway
