#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "planning/check/path_check.hpp"
#include "planning/path/motion.hpp"
#include "planning/robot/load.hpp"

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
  int leg = -1;                ///< of a pick on which the fault is, from 0; -1: not known, or none
};

/// A motion, and what is stated of it.
struct MotionToCheck {
  const Motion& motion;
  const std::vector<std::size_t>& rests;  ///< the knot at which each leg ends, at rest
  std::vector<Configuration> stops;       ///< where each leg begins and ends: one more than `rests`
  RateLimits limits;
  double grip_time = 0.0;  ///< seconds that the robot rests for each load that begins or ends to ride
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

/// The same of a robot that carries loads, whichever its planner carried: the tubes of each leg are proved
/// with the loads that ride on it, and where a load begins or ends to ride between two legs the robot rests
/// for `grip_time`, in whole periods, for each of them. That rest is proved with the loads before and after.
/// @param robot without loads
MotionVerdict check_motion(const Robot& robot, const Snapshot& map,
                           const std::map<std::string, Policy>& policies, double padding,
                           const MotionToCheck& motion, const std::vector<LegLoad>& loads,
                           double seen_within = 0.0);

/// How many loads begin or end to ride after each leg but the last.
std::vector<std::size_t> grips_between(const std::vector<LegLoad>& loads, std::size_t legs);

/// All that check_motion says of a motion but what it may touch. @param grips after each leg but the last
/// @throws std::invalid_argument for limits that are not above 0, one for each joint.
MotionVerdict check_rates(const Robot& robot, const MotionToCheck& motion,
                          const std::vector<std::size_t>& grips);

/// Knots of a motion, the first and the last.
struct KnotRange {
  std::size_t first = 0, last = 0;
};

/// The knots of each leg, from where the one before came to rest to the end of its own rest.
/// @pre check_rates found the motion valid
std::vector<KnotRange> knots_of_legs(const MotionToCheck& motion, const std::vector<std::size_t>& grips);

/// Chords of a motion between two knots, and how far its cubics leave each of them.
struct MotionTubes {
  std::vector<Configuration> chords;
  std::vector<Eigen::VectorXd> deviations;  ///< of each joint, rad or m
};
/// @param most knots that one chord may stand for, where it is close enough
MotionTubes tubes_of(const Motion& motion, KnotRange knots, std::size_t most);

/// check_tubes of a part of a motion, about few long chords first; where these are too wide, about each
/// cubic. Lowers the verdict's clearance, or makes it a refusal.
void prove_tubes(const Robot& robot, const Snapshot& map, const std::map<std::string, Policy>& policies,
                 double padding, double seen_within, const Motion& motion, KnotRange knots,
                 MotionVerdict& verdict);

}  // namespace clearway
