#pragma once

#include <vector>

#include "planning/kinematics.hpp"

namespace clearway {

/// How a path is given time. Per joint: rad and rad/s for a revolute joint, m and m/s for a prismatic one.
struct TrajectoryOptions {
  double sampling_period = 0.008;     ///< T, seconds between points
  double velocity_scale = 1.0;        ///< 0 < scale <= 1, of every velocity limit
  double default_max_velocity = 1.0;  ///< for joints whose URDF gives none, rad/s or m/s
  double max_acceleration = 5.0;      ///< a, of every joint, rad/s^2 or m/s^2
};

/// A moment of the motion.
struct TrajectoryPoint {
  double time = 0.0;  ///< seconds since the start
  Configuration position, velocity;
};

/// A path with time. Point k is at k * sampling_period.
struct Trajectory {
  double sampling_period = 0.0;  ///< seconds
  std::vector<TrajectoryPoint> points;
};

/// The motion along the straight joint-space edges between `waypoints`, without blending, from rest to rest:
/// along each edge a trapezoid of the path speed, its ends bounded by a forward and a backward pass.
///
/// Promised, within rounding, for the motion and so for its samples:
/// - every position lies on an edge of the path; the first and the last are the end waypoints, bit for bit;
/// - every joint keeps velocity_scale times its velocity limit, and `a` along each edge;
/// - at a waypoint where the direction changes no joint's velocity jumps by more than a T (the junction speed
///   of numeric controls), nor by more than a/2 times the motion's time on either of its two edges. So over
///   any one period, however many waypoints it holds, no joint's velocity changes by more than 2.5 a T.
/// Not promised: a bound on jerk, the least time, or what a controller does between samples.
///
/// The motion is slowed by less than one period so that it lasts a whole number of them. Equal waypoints in
/// a row count once; a path of one point is one sample at rest.
/// @throws std::invalid_argument for no waypoints, a wrong size, a value that is not finite, an option out of
///         range, or a motion of more than ten million samples.
Trajectory time_path(const Robot& robot, const std::vector<Configuration>& waypoints,
                     const TrajectoryOptions& options = {});

}  // namespace clearway
