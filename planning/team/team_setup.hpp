#pragma once

// Private to the sources of run_team.

#include "planning/team/team.hpp"

namespace clearway {

/// The values in force; see TeamFigures. @throws std::invalid_argument for distances that do not fit.
TeamFigures choose_figures(const Team& team, const TeamOptions& options);

/// Start and goal of each robot by itself, then against the others and, at the start, the obstacles: solved,
/// or start_invalid or goal_invalid with the sentence.
PlanResult check_team_ends(const Team& team, const TeamOptions& options);

}  // namespace clearway
