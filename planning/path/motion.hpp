#pragma once

#include <cstddef>
#include <vector>

#include "planning/robot/kinematics.hpp"

namespace clearway {

/// What a motion keeps, one value for each joint: rad/s, rad/s^2, rad/s^3 of a revolute joint, m of a
/// prismatic one.
struct RateLimits {
  Eigen::VectorXd velocity, acceleration, jerk;
};

/// What the limits are made of. A joint's own limits (Joint::max_velocity of the URDF, max_acceleration and
/// max_jerk of the robot's settings) come first, else these; the scales are of all.
struct MotionScales {
  double speed = 1.0, acceleration = 1.0, jerk = 1.0;  ///< 0 < scale <= 1
  double default_velocity = 1.0;                       ///< rad/s or m/s
  double default_acceleration = 5.0;                   ///< rad/s^2 or m/s^2
  double default_rise_time = 0.05;  ///< seconds in which a joint's whole acceleration builds up: its jerk
                                    ///< limit is acceleration / rise time
};

/// @throws std::invalid_argument for a scale outside 0 to 1 or a default that is not above 0, naming it.
RateLimits rate_limits(const Robot& robot, const MotionScales& scales = {});

/// A moment of a motion.
struct MotionState {
  Configuration position;
  Eigen::VectorXd velocity, acceleration, jerk;
};

/// A motion in time: knots every `period`; between two of them each joint follows the cubic with the
/// positions and velocities of both (Hermite). Accelerations of neighbours agree where they meet, so that
/// jerk is constant between knots and acceleration continuous. A controller that interpolates positions and
/// velocities by cubics, or accelerations too by quintics, follows the very same curve.
struct Motion {
  double period = 0.0;  ///< seconds
  std::vector<Configuration> positions;
  std::vector<Eigen::VectorXd> velocities, accelerations;

  bool empty() const { return positions.empty(); }
  double duration() const {
    return positions.empty() ? 0.0 : period * static_cast<double>(positions.size() - 1);
  }
  /// At a time from 0 to duration(); beyond, at rest at the end. @pre not empty
  MotionState at(double time) const;
};

/// The uniform cubic B-spline of control points, one each period, as a motion: its knots are those of control
/// points 1 to n - 2. Velocities, accelerations and jerks are bounded by the first, second and third
/// differences of the control points over the period, its square and its cube (de Boor 1978), and each piece
/// lies in the hull of four control points.
/// @pre at least three control points of one size
Motion spline_motion(const std::vector<Configuration>& control, double period);

/// Accelerations at the knots of the cubics with these positions and velocities: where each begins, and where
/// the last ends. @pre as many velocities as positions
std::vector<Eigen::VectorXd> hermite_accelerations(const Motion& motion);

/// The motion, then the next, which begins at rest where this one ends at rest.
void append(Motion& motion, const Motion& next);

/// At rest where it ends for so many periods. @pre it ends at rest
void append_rest(Motion& motion, std::size_t periods);

/// The motion between two of its knots, as one of its own. @pre first <= last < positions.size()
Motion stretch_of(const Motion& motion, std::size_t first, std::size_t last);

/// The greatest of each joint at any time, exact but for rounding; of no joint for a motion without knots.
RateLimits greatest_rates(const Motion& motion);

/// The greatest rates as shares of the limits, over all joints: 1 is all of them.
struct MotionShares {
  double velocity = 0.0, acceleration = 0.0, jerk = 0.0;
};
MotionShares shares_of(const RateLimits& rates, const RateLimits& limits);

}  // namespace clearway
