#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "planning/robot/kinematics.hpp"

namespace clearway {

/// Some timed configurations that another program (a learned policy, an operator, a script) wants an arm to
/// pass. Straight joint-space edges join them, each joint at a constant rate on each.
struct MotionChunk {
  static constexpr std::size_t fewest = 2, most = 64;  ///< configurations

  std::vector<double> times;             ///< seconds, growing, of any clock
  std::vector<Configuration> positions;  ///< radians and metres, one for each time
};

/// How fast joints may move and how they brake; rad/s or m/s, rad/s^2 or m/s^2. A list holds one value for
/// all joints, or one for each.
struct MotionLimits {
  /// At most these, and at most the robot's own. Empty: the robot's own, and 1.0 where it has none.
  std::vector<double> max_velocity = {};  ///< each > 0
  /// With which the joints brake, at most their own acceleration limit where they have one, > 0.
  std::vector<double> deceleration = {5.0};
  double reaction = 0.0;       ///< seconds at the last velocity before they begin to, >= 0
  double max_duration = 60.0;  ///< of a chunk, seconds, > 0
};

/// Why a chunk is passed or refused.
enum class GateReason {
  none,  ///< passed
  not_a_chunk,
  line_too_long,
  no_map,
  too_short,
  too_long,
  wrong_size,
  not_finite,
  time_order,
  lasts_too_long,
  joint_limit,
  velocity_limit,
  stale_map,
  jump,
  blocked,         ///< a voxel
  self_collision,  ///< another body
  outside_map,     ///< a part leaves the map's bounds, which its policy would let pass in silence
  not_proved       ///< too near to something to be proved free
};
std::string_view to_string(GateReason reason);

/// What is wrong with a chunk by itself, whatever the map.
struct ChunkFault {
  GateReason reason = GateReason::none;
  std::string sentence;
};

/// The same, written out for each joint of a robot.
struct JointLimits {
  Eigen::VectorXd max_velocity, deceleration;
  double reaction = 0.0, max_duration = 60.0;
};

/// Refuses limits that are out of range for every robot. @throws std::invalid_argument
void require_limits(const MotionLimits& limits);

/// @throws std::invalid_argument for limits out of range, or lists that do not fit the robot.
JointLimits joint_limits(const Robot& robot, const MotionLimits& limits);

/// What is wrong with a chunk before any map is asked: number and size of its configurations, values that are
/// not finite, times that repeat or go back, its duration, joint limits, velocities. The first in this order.
ChunkFault find_fault(const MotionChunk& chunk, const Robot& robot, const JointLimits& limits);

/// The chunk with each position at its joint's limit that is beyond it by no more than what single precision
/// rounds, as learned policies send them; none: there is no such position, or sizes do not fit the robot.
std::optional<MotionChunk> drawn_to_limits(const MotionChunk& chunk, const Robot& robot);

/// Joint rates from configuration `edge` to the next. @pre find_fault finds none
Eigen::VectorXd edge_velocity(const MotionChunk& chunk, std::size_t edge);

/// Whether the joints cannot turn from edge `waypoint` - 1 into edge `waypoint`: the rate of one changes by
/// more than its deceleration makes in the shorter of the two edges' times.
bool is_sharp(const MotionChunk& chunk, std::size_t waypoint, const JointLimits& limits);

/// Where joints come to rest that move at `velocity` in `from`: on for the reaction time, then braking all in
/// proportion, one with its deceleration: from + velocity (reaction + T / 2), T = max |v_j| / d_j.
Configuration stop_from(const Configuration& from, const Eigen::VectorXd& velocity,
                        const JointLimits& limits);

}  // namespace clearway
