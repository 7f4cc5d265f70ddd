#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "planning/robot/kinematics.hpp"

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
  Configuration acceleration{};  ///< rad/s^2 or m/s^2; of no size where none is known
};

/// What the hand does while the arm rests.
struct TrajectoryEvent {
  enum class Kind { attach, detach };  ///< the load begins or ends to ride on the robot
  Kind kind = Kind::attach;
  std::string load;
  double time = 0.0;  ///< seconds since the start: the arm has come to rest
  double rest = 0.0;  ///< seconds until it goes on
};
std::string_view to_string(TrajectoryEvent::Kind kind);

/// Seconds that a hand is given to grasp or to let go.
constexpr double usual_grip_time = 1.0;
constexpr double most_grip_time = 60.0;

/// A path with time. Point k is at k * sampling_period.
struct Trajectory {
  double sampling_period = 0.0;  ///< seconds
  std::vector<TrajectoryPoint> points;
  std::vector<TrajectoryEvent> events{};  ///< in the order of time
};

/// The motion along the straight joint-space edges between `waypoints`, without blending, from rest to rest:
/// along each edge a trapezoid of the path speed, its ends bounded by a forward and a backward pass. Where
/// the direction changes the velocity jumps; speeds at waypoints, and where these lie close, are so low that
/// the jumps within a period, and what the joints accelerate in it, stay within a T together.
///
/// Promised, within rounding:
/// - every position lies on an edge of the path; the first and the last are the end waypoints, bit for bit;
/// - every joint keeps velocity_scale times its velocity limit at any time;
/// - from one sample to the next no joint's velocity changes by more than a T, nor its step (the difference
/// of
///   two positions) by more than a T^2: a controller that sees the samples alone sees `a` kept.
/// Not promised: a bound on jerk, the least time, or what a controller does between samples.
///
/// The motion is slowed by less than one period so that it lasts a whole number of them. Equal waypoints in
/// a row count once; a path of one point is one sample at rest.
/// @throws std::invalid_argument for no waypoints, a wrong size, a value that is not finite, an option out of
///         range, or a motion of more than ten million samples.
Trajectory time_parameterize(const Robot& robot, const std::vector<Configuration>& waypoints,
                             const TrajectoryOptions& options = {});

/// How much of the limits a trajectory uses, from sample to sample: 1 is all of them.
struct LimitShares {
  double velocity = 0.0;      ///< of a joint's own limit (or the default), velocity_scale not counted
  double acceleration = 0.0;  ///< of `a`: change of velocity over a period
};
/// @throws std::invalid_argument unless each velocity is one finite value for each joint of the robot
LimitShares limit_shares(const Robot& robot, const Trajectory& trajectory,
                         const TrajectoryOptions& options = {});

/// The velocity limit of joint `j`, rad/s or m/s: its own, else the default.
double velocity_limit(const Robot& robot, std::size_t j, const TrajectoryOptions& options = {});

/// A motion along the path within these limits takes at least that long, s.
/// @pre each waypoint is one value for each joint
double least_duration(const Robot& robot, const std::vector<Configuration>& path);

}  // namespace clearway
