#pragma once

#include <string>

#include "apps/report_page.hpp"
#include "planning/team_check.hpp"

namespace clearway {

/// A page with the team's robots, each in its colour, and its obstacles.
/// @param map of the first robot, whose voxels are shown
ReportPage page_of_team(const Team& team, const Snapshot& map, const std::string& title);

/// A run as the page animates it: at most 600 waypoints, evenly in time, with separations and figures.
PagePlan page_of_run(const Team& team, const TeamRun& run, const TeamVerdict& verdict,
                     const std::string& label, const std::string& planner);

/// All that moved, sample by sample, and what the check found: one JSON object.
std::string team_json(const Team& team, const TeamRun& run, const TeamVerdict& verdict,
                      const std::string& planner, const PlannerOptions& options);

}  // namespace clearway
