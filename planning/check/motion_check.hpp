#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "planning/check/path_check.hpp"
#include "planning/path/motion.hpp"

namespace clearway {

/// What the independent check found of a motion.
struct MotionVerdict {
  bool valid = false;
  bool undecided = false;      ///< PathVerdict::undecided
  std::string fault;           ///< one sentence; empty when valid
  double min_clearance = 0.0;  ///< to blocked voxels: certified lower bound over the whole motion, metres
  MotionShares shares{};       ///< of the limits, as sampled
  std::size_t samples = 0;     ///< at which velocity, acceleration and jerk were compared
  std::size_t edges = 0;       ///< tubes that were proved
};

/// Re-checks a motion in code of its own: from the positions and velocities at the knots alone, as a
/// controller that interpolates them by cubics would follow them.
/// - It is finite, begins at rest at `stops.front()`, ends at rest at `stops.back()`, and rests at each of
/// the
///   others in their order: at the knots `rests`.
/// - The accelerations in the file are those of the cubics, on both sides of each knot.
/// - At a thousand samples a second or more, and at each knot, no joint exceeds its velocity, acceleration or
///   jerk limit by more than a millionth, nor its position limits.
/// - Every configuration in between is free under the contract of check_path: tubes about chords hold the
///   control points of the cubics, and with them the cubics.
/// @param stops where each leg begins and ends: one more than `rests`
/// @throws std::invalid_argument as check_path, and for limits that are not above 0, one for each joint.
MotionVerdict check_motion(const Robot& robot, const Snapshot& map,
                           const std::map<std::string, Policy>& policies, double padding,
                           const Motion& motion, const std::vector<std::size_t>& rests,
                           const std::vector<Configuration>& stops, const RateLimits& limits,
                           double seen_within = 0.0);

}  // namespace clearway
