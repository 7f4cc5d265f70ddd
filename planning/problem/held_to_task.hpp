#pragma once

#include <string_view>

#include "planning/problem/planner.hpp"

namespace clearway {

/// What the planner answers, held to what was asked: planners may be the caller's own. A path that has no
/// waypoints, or one that is not one finite value for each joint, or that does not lead from the start to the
/// goal (of a beam search: to the goal's box, Chong 2008, eq. 11) is `no_path` with the reason; waypoints of
/// an answer that is not solved are dropped, costs and distances that are not finite replaced.
PlanResult held_to_task(const Planner& planner, const PlanProblem& problem);

/// Whether a solved leg of a beam search ends in the goal's box (Chong 2008, eq. 11), as far from the goal as
/// it says. @param planner its name @pre the leg has waypoints of the goal's size
bool ends_in_goal_box(std::string_view planner, const PlanResult& leg, const Configuration& goal);

}  // namespace clearway
