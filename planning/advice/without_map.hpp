#pragma once

#include "planning/problem/planner.hpp"

namespace clearway {

/// Whether start and goal of a problem without a solution are kept apart by the robot itself, its bodies that
/// touch each other or its joints' limits: some ten thousand samples find no path in an empty map either.
/// False when time is out before.
bool is_without_path_in_empty_map(const PlanProblem& problem);

}  // namespace clearway
