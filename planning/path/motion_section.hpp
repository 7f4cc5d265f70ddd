#pragma once

// Not part of the installed library.

#include <algorithm>
#include <cstddef>
#include <optional>
#include <utility>
#include <vector>

#include "planning/path/path_timing.hpp"
#include "planning/path/smooth_motion.hpp"

namespace clearway {

/// How hard a motion is driven before it is averaged: less acceleration, and a level speed between
/// acceleration and braking, need a shorter window for the same jerk.
struct MotionDrive {
  double rise = 0.0;  ///< seconds: each joint accelerates by no more than its jerk builds up in this time
  bool is_level = false;
  double share = 1.0;         ///< of the acceleration limits
  double torque_share = 0.0;  ///< of what gravity leaves; 0: torques do not bind
};

/// A motion from rest to rest. Control point i is the mean of samples i - 1 - window to i - 2, knot i stands
/// at control point i + 1; what lies before the first sample and after the last rests.
struct MotionSection {
  std::vector<Configuration> waypoints;
  std::vector<double> reach;  ///< of each waypoint
  std::vector<int> halved;    ///< how often
  SmoothPath path;
  PathSamples samples;
  std::size_t window = 1;
  std::optional<MotionDrive> drive;  ///< once it is chosen
  std::vector<Configuration> control;
  Motion motion;

  std::size_t clamped(std::ptrdiff_t sample) const {
    const auto last = static_cast<std::ptrdiff_t>(samples.positions.size()) - 1;
    return static_cast<std::size_t>(std::clamp<std::ptrdiff_t>(sample, 0, last));
  }
  std::size_t piece_of(std::ptrdiff_t sample) const { return samples.pieces[clamped(sample)]; }
  /// The first and last piece of the path that the motion between knots i and i + 1 is made of.
  std::pair<std::size_t, std::size_t> pieces_of(std::size_t i) const {
    const auto k = static_cast<std::ptrdiff_t>(i);
    return {piece_of(k - 1 - static_cast<std::ptrdiff_t>(window)), piece_of(k + 1)};
  }
  /// Whether the motion between knots i and i + 1 lies on one edge.
  bool is_on_edge(std::size_t i) const {
    const auto [first, last] = pieces_of(i);
    return first == last && path.pieces[first].is_straight();
  }
};

/// A section of straight edges with blends that reach `share` of the edges at them, not timed yet.
/// @pre two waypoints or more, neighbours differ
MotionSection section_of(std::vector<Configuration> waypoints, double share);

/// The waypoints from `first` to `last` with what is known of their blends, not timed yet.
MotionSection part_of(const MotionSection& whole, std::size_t first, std::size_t last);

/// Times the section within the limits and, slower if need be, within the torques that `options` state.
/// @throws std::invalid_argument as smooth_motion for a motion that is too long or jerk limits that are too
///         low
void time_section(MotionSection& section, const Robot& robot, const RateLimits& limits,
                  const SmoothMotionOptions& options);

}  // namespace clearway
