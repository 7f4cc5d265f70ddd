#pragma once

#include "apps/results/compare_results.hpp"
#include "planning/team/team_check.hpp"

namespace clearway {

/// How a team's run went beside what the team itself reports.
struct TeamCircumstances {
  double unseen_motion = 0.0;  ///< m: how far something that is only sensed moves from when it is seen until
                               ///< the next scan is known
  bool is_cut_short = false;   ///< the clock ended it
  std::vector<double> payloads = {};         ///< kg at the tip of each robot, full size; none: empty hands
  Eigen::Vector3d gravity{0.0, 0.0, -9.81};  ///< m/s^2, map frame
};

/// What `compare` makes of a run. `check` is
/// - "valid": the separation never fell below d_s by more than `step_bound`;
/// - "outrun": at some time a robot could not keep it, whatever it did, so the run counts neither way;
/// - "unfinished": it was kept as long as the clock let the run last;
/// - "none": nothing moved; "refused": anything else.
/// Planner, number, seed, time and files are left to the caller.
CompareRun team_result(const Team& team, const TeamRun& run, const TeamVerdict& verdict,
                       const TeamCircumstances& circumstances);

}  // namespace clearway
