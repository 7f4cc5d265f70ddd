#pragma once

#include <cstddef>
#include <functional>
#include <memory>
#include <vector>

#include "planning/path/motion.hpp"
#include "planning/robot/inverse_dynamics.hpp"
#include "planning/space/configuration_space.hpp"

namespace clearway {

/// Limits, time step, straightening and blending of smooth_motion.
struct SmoothMotionOptions {
  MotionScales scales{};  ///< of the joints' velocity, acceleration and jerk limits
  std::shared_ptr<const TorqueTerms> torques = nullptr;  ///< whose limits are kept; null: none
  double period = 0.008;                                 ///< between knots, seconds
  double straighten = 0.1;  ///< rad or m: waypoints no joint of which is farther from a certified edge are
                            ///< left out; 0: none
  double reach =
      0.5;  ///< of each edge that a blend at its end may take, 0 to 0.5, and 1.6 times as much of the
            ///< first and last edge of a leg; 0: the motion follows
            ///< the edges and stops at each waypoint
  int halvings = 6;  ///< of a blend that is not proved, before the motion stops at its waypoint
  /// Whether all places are free from which no joint is farther than `aside` from one of the edge; null:
  /// ConfigurationSpace::is_edge_free.
  std::function<bool(const Configuration& from, const Configuration& to, const Eigen::VectorXd& aside)>
      is_tube_free = nullptr;
};

/// A motion, and how the waypoints of its path are passed.
struct SmoothMotion {
  Motion motion;
  std::vector<std::size_t> leg_ends;  ///< the knot at which each leg ends, at rest
  std::size_t straightened = 0;       ///< waypoints that were left out
  std::size_t blended = 0;            ///< waypoints that are passed without a stop
  std::size_t stops = 0;              ///< waypoints between the ends of a leg where the motion stops
};

/// Motion along a certified path under limits of velocity, acceleration and jerk, from rest to rest along
/// each leg; all that it passes is proved free.
/// 1. Waypoints that certified edges can do without are left out, the others become parabolas.
/// 2. Time-optimal under velocity and acceleration (path_timing.hpp).
/// 3. Averaged over a window of time, as control points of a cubic spline: velocities and accelerations stay
///    within what they were, and jerk within the change of acceleration over the window (Biagiotti and
///    Melchiorri, "FIR filters for online trajectory planning with time- and frequency-domain
///    specifications", 2012). Of several times in which acceleration may build up, with and without level
///    speed between acceleration and braking, the one that ends first is taken.
/// 4. The spline lies on the edges but near blends; there it is proved, piece by piece, by certified chords
///    with tubes that hold its control points. A blend that is not proved is halved, at last a stop.
///
/// Where a torque exceeds its limit, the path between two stops is timed under torque limits, too
/// (path_torques.hpp), and with less acceleration; what ends first is taken. Joints of whose limit gravity
/// alone takes 99 % on the way are let be: slower motion hardly helps them, and greatest_torques
/// (check/motion_torques.hpp) judges whether they hold.
///
/// Wider limits hardly ever make a motion slower; where torques bind a path of many waypoints, that is not
/// promised.
///
/// Limits of velocity, acceleration and jerk hold at all times, within rounding. Positions are averages of
/// points of the path, so that joint limits hold too. The same on every machine; nothing depends on time.
/// @param legs waypoints of each leg, whose edges are certified in `space`; each begins where the last ended
/// @throws std::invalid_argument for no legs or an empty one, waypoints of a wrong size, not finite or beyond
/// largest_joint_value, legs
///         that do not join, an option out of range, a motion of more than a million samples a leg, or jerk
///         limits by which a leg takes more than a minute, naming the least scale that helps.
SmoothMotion smooth_motion(const ConfigurationSpace& space,
                           const std::vector<std::vector<Configuration>>& legs,
                           const SmoothMotionOptions& options = {});

}  // namespace clearway
