#pragma once

#include <memory>

#include "apps/compare/problem_server.hpp"

namespace clearway {

/// The map of a team experiment's world; without a world, a map of nothing.
/// @throws std::invalid_argument when it cannot be loaded or made
Snapshot team_map(const Suite& suite, const SuiteExperiment& experiment);

std::size_t count_teams(const SuiteExperiment& experiment);

/// Of an experiment with teams, which is one stage: has every run judged by check_team and team_result. A run
/// that takes more than the experiment's time limit (wall clock) ends there. For teams that are written out,
/// and for runs that are refused, what moved is saved as JSON below `teams/`, and an animation of each such
/// team as a page beside it.
std::unique_ptr<ProblemServer> make_team_server(const Suite& suite, const PreparedExperiment& experiment,
                                                const CompareChoice& choice);

}  // namespace clearway
