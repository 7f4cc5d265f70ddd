#pragma once

#include <string>

#include "apps/pages/report_page.hpp"
#include "apps/results/compare_results.hpp"
#include "planning/team/team_check.hpp"

namespace clearway {

/// A page with the team's robots, each in its colour, and its obstacles.
/// @param map of the first robot, whose voxels are shown
ReportPage page_of_team(const Team& team, const Snapshot& map, const std::string& title);

/// A run as the page animates it, as show_motion has it, with separations and figures.
/// @param found what compare makes of it @param max_acceleration the limit of every joint, rad/s^2 or m/s^2
PagePlan page_of_run(const Team& team, const TeamRun& run, const TeamVerdict& verdict,
                     const CompareRun& found, double max_acceleration, const std::string& label);

/// All that moved, sample by sample, and what the check found: one JSON object.
std::string team_json(const Team& team, const TeamRun& run, const TeamVerdict& verdict,
                      const std::string& planner, const PlannerOptions& options);

}  // namespace clearway
