#pragma once

#include <functional>

#include "apps/compare/compare_run.hpp"

namespace clearway {

/// The map of a team experiment's world; without a world, a map of nothing.
/// @throws std::invalid_argument when it cannot be loaded or made
Snapshot team_map(const Suite& suite, const SuiteExperiment& experiment);

/// Runs the teams of an experiment, each with every planner, and has every run judged by check_team and
/// team_result. A run that takes more than the experiment's time limit (wall clock) ends there.
/// For teams that are written out, and for runs that are refused, what moved is saved as JSON below
/// `teams/`, and an animation of each such team as a page beside it.
CompareExperiment run_team_experiment(const Suite& suite, const PreparedExperiment& experiment,
                                      const CompareChoice& choice,
                                      const std::function<void(double)>& progress);

}  // namespace clearway
