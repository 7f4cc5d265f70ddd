#pragma once

#include <filesystem>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "apps/check/trajectory_plan.hpp"
#include "planning/check/motion_torques.hpp"
#include "planning/check/spline_check.hpp"

namespace clearway {

/// A trajectory with times, as a controller takes it.
struct TimedTrajectory {
  std::vector<SplinePoint> points;  ///< in the robot's order of joints
  /// Where the robot is before a first point whose time is 0; of no size: there.
  Configuration before{};
  std::string fault{};               ///< why no controller can run it, one sentence; else empty
  std::vector<std::string> notes{};  ///< what is not judged, one sentence each
  std::string moving_start{};        ///< a sentence where the first point has a velocity too soon after 0 s
  std::string moving_end{};          ///< a sentence where the last point has a velocity; else empty
  bool has_start = false;  ///< the first of `points` is where the robot rests before the file's first
  /// With a start whole turns of endless joints nearer to the first point than the file states: as it states
  /// it. Of no size: the same.
  Configuration stated_start{};
  std::string field{};  ///< of the trajectory
};

/// The trajectory with its times; none of one without. From where the file says that the robot is before, at
/// rest, a controller goes to the first point in that point's time. A first time of 0 leaves none: the robot
/// may then stand 0.01 rad or m beside that point, as MoveIt allows (`allowed_start_tolerance`).
/// @throws std::invalid_argument naming `file` and a joint that stands still, but that velocities or
/// accelerations between its points would move by more than 1e-4 rad or m.
std::optional<TimedTrajectory> timed_trajectory(const ForeignTrajectory& trajectory, const Robot& robot,
                                                const std::filesystem::path& file);

/// check_splines of it, from where the robot is before: by each curve that a controller may take from there,
/// and of endless joints by the shorter way, as controllers of ROS 2 since Jazzy go, and as far as numbers
/// say; `path` then covers the way to the first point, too.
/// Where straight lines meet, and where they begin or end at rest, a limit of acceleration that no motion
/// through the points keeps is exceeded.
/// @param robot with the loads that it carries
SplineVerdict check_timed(const TimedTrajectory& trajectory, const Robot& robot, const Snapshot& map,
                          const std::map<std::string, Policy>& policies, double padding, double seen_within);

/// Torques along it, by KDL, at least every 8 ms; at level speed on straight lines, at whose ends velocities
/// jump. One beyond its limit by more than 0.1 %, which the rounding of a file may take, becomes the fault of
/// `verdict`. @pre the verdict is valid
TorqueFinding torques_of(const TimedTrajectory& trajectory, const Robot& robot, const JointLoad& load,
                         SplineVerdict& verdict);

/// "the trajectory is judged as ROS's joint_trajectory_controller runs it: 12 cubics, 1 straight line …"
std::vector<std::string> notes_of(const TimedTrajectory& trajectory, const SplineVerdict& verdict);

}  // namespace clearway
