#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "planning/check/path_check.hpp"
#include "planning/path/motion.hpp"

namespace clearway {

/// A point of a trajectory that a controller interpolates.
struct SplinePoint {
  double time = 0.0;  ///< seconds, later than that of the point before
  Configuration position;
  Eigen::VectorXd velocity{}, acceleration{};  ///< one value for each joint; of no size: not given
};

/// The greatest rate that is not compared with a limit, and where it is.
struct RatePeak {
  double value = 0.0;     ///< absolute, rad or m, per s, s^2 or s^3
  std::size_t joint = 0;  ///< index
  double time = 0.0;      ///< seconds
  std::string part{};     ///< which of several trajectories; empty of one
};
/// Takes a peak that is greater than what is known.
void raise(std::optional<RatePeak>& known, const std::optional<RatePeak>& other);

/// What the independent check found of such a trajectory.
struct SplineVerdict {
  PathVerdict path;   ///< of the curve; `edge` is that from point `edge` to the next, `parameter` a share of
                      ///< its time; without `clearance`
  std::string fault;  ///< one sentence where a limit of velocity or acceleration is exceeded; else empty
  std::optional<double> velocity_share, acceleration_share;  ///< of limits, the greatest; none: none is known
  /// Of joints whose limit is not known, accelerations on curves alone; none: there is no such joint.
  std::optional<RatePeak> free_velocity{}, free_acceleration{};
  std::optional<RatePeak> jerk{};  ///< of any joint, between points; none: there are straight lines alone
  std::size_t lines = 0, cubics = 0, quintics = 0;  ///< edges of each kind
  std::vector<Configuration> chords{};              ///< that hold the curve to 0.5 mrad or mm

  bool is_valid() const { return path.valid && fault.empty(); }
};
/// Takes the greater of the rates that are not compared with limits.
void raise_peaks(SplineVerdict& verdict, const SplineVerdict& other);

/// Checks a trajectory as ROS's joint_trajectory_controller runs it, in code that no planner shares. Between
/// two points the controller follows the spline of the highest degree for which both have what it takes: the
/// cubic of positions and velocities, the quintic of accelerations, too, else a straight line (ros2_control,
/// joint_trajectory_controller, "Trajectory Representation"; Trajectory::interpolate_between_points. That of
/// ros_control does the same).
/// - Every configuration of the curve is free under the contract of check_path. Each polynomial is cut in
///   halves (de Casteljau) until tubes about chords, at most 5e-4 rad or m wide, hold its Bezier control
///   points, and with them the curve: check_tubes proves these, and where it does not those of a tenth of
///   the width.
/// - No joint leaves its limits, within 1e-9 rad or m.
/// - No joint exceeds its max_velocity, nor on cubics and quintics its max_acceleration, by more than a
///   millionth and what rounding of positions, velocities and times by 5e-10 may do, of velocities also that
///   of positions to single precision, at most 1 %; nor does a velocity or acceleration that a point states
///   and a curve takes. Limits of 0 are not known and not compared. Accelerations of straight lines are not
///   compared: there velocities jump. Nor is jerk, which the controller does not limit.
/// What happens before the first point and after the last is not covered, nor how far the arm lags behind.
/// @throws std::invalid_argument as check_path, and in one sentence for no points, values that are not
///         finite, sizes that are not those of the robot, times that do not rise, accelerations without
///         velocities, or a curve for which 200,000 tubes are too few.
SplineVerdict check_splines(const Robot& robot, const Snapshot& map,
                            const std::map<std::string, Policy>& policies, double padding,
                            const std::vector<SplinePoint>& points, double seen_within = 0.0);

/// Times, seconds, and states of the curve that check_splines looks at, without jerk: at each point, from
/// either side, and between two at least every 8 ms, but for those of more than 8000 s, and seven at least.
/// On straight lines accelerations are 0. @pre check_splines accepts the points
std::vector<std::pair<double, MotionState>> spline_states(const std::vector<SplinePoint>& points);

}  // namespace clearway
