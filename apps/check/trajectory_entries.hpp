#pragma once

#include <filesystem>
#include <map>
#include <string>
#include <vector>

#include "apps/check/timed_trajectory.hpp"
#include "apps/check/trajectory_file.hpp"

namespace clearway {

/// Trajectories that are executed one after the other, each from rest to rest, as MoveIt executes those of a
/// DisplayTrajectory: names each, and gives all but the first as their start where the ones before left the
/// joints. A joint that neither the first nor `start` names stands where the first that names it begins.
/// Nothing of a single trajectory changes.
/// @throws std::invalid_argument in one sentence that names `file`, entry and joint for an entry that begins
/// more than 1e-4 rad or m from where the ones before left the joint, that moves where it begins or ends
/// between two, or that has no times where others have.
void join_entries(std::vector<ForeignTrajectory>& entries, const std::filesystem::path& file);

/// plan_of_trajectory of all of them, in one leg.
Plan plan_of_trajectories(const std::vector<ForeignTrajectory>& entries, const Robot& robot,
                          const std::filesystem::path& file);

/// timed_trajectory of each; none where there are no times.
std::vector<TimedTrajectory> timed_trajectories(const std::vector<ForeignTrajectory>& entries,
                                                const Robot& robot, const std::filesystem::path& file);

/// check_timed of each up to the first that is not valid; its sentences, and its edge, are of that one, which
/// they name.
SplineVerdict check_timed(const std::vector<TimedTrajectory>& entries, const Robot& robot,
                          const Snapshot& map, const std::map<std::string, Policy>& policies, double padding,
                          double seen_within);

/// torques_of each, the greatest of them.
TorqueFinding torques_of(const std::vector<TimedTrajectory>& entries, const Robot& robot,
                         const JointLoad& load, SplineVerdict& verdict);

/// notes_of them, each once.
std::vector<std::string> notes_of(const std::vector<TimedTrajectory>& entries, const SplineVerdict& verdict);

/// Seconds that they take, rests between them left out.
double duration_of(const std::vector<TimedTrajectory>& entries);

}  // namespace clearway
