#pragma once

#include <cstddef>
#include <vector>

#include "planning/path/path_torques.hpp"
#include "planning/path/smooth_path.hpp"

namespace clearway {

/// Positions of a motion from rest to rest, one each period, and the pieces of the path they lie on.
struct PathSamples {
  std::vector<Configuration> positions;
  std::vector<std::size_t> pieces;
};

/// The parts of a path between the places where speeds are found.
std::vector<PathStretch> timed_stretches(const SmoothPath& path);

/// Of the stretches of a path, and the share of what gravity leaves of them that may be taken.
struct TorqueShare {
  const std::vector<StretchTorques>* along = nullptr;  ///< null: torques have no limits
  double share = 1.0;
};

/// The time-optimal motion along the path under limits of joint velocity and acceleration, by reachability
/// (TOPP-RA: Pham and Pham, "A new approach to time-optimal path parameterization based on reachability
/// analysis", 2018): a backward pass finds the greatest speeds from which the end can be reached, a forward
/// pass takes the greatest acceleration that stays below them. The path acceleration is constant between
/// nodes; on pieces of constant d2q/ds2 every joint's acceleration is then linear in s, so that limits kept
/// at the nodes are kept at all times, within rounding. The motion rests at both ends.
/// @param max_velocity, max_acceleration of each joint, above 0, rad/s or m/s, and by second
/// @param period seconds, > 0
/// @param cruise seconds, >= 0: where acceleration would turn into braking at once, the speed is lowered so
/// that it
///        stays level that long in between, if limits allow; the motion then is no longer the fastest one
/// @param torques limits of torques, which are kept at the ends of stretches
/// @throws std::invalid_argument for a motion of more than a million samples.
PathSamples time_optimal_samples(const SmoothPath& path, const Eigen::VectorXd& max_velocity,
                                 const Eigen::VectorXd& max_acceleration, double period, double cruise = 0.0,
                                 const TorqueShare& torques = {});

}  // namespace clearway
