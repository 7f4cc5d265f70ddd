#pragma once

#include "apps/pages/report_page.hpp"
#include "apps/suites/sensed_spaces.hpp"
#include "planning/team/team.hpp"

namespace clearway {

/// Adds to a run's page what sensors saw anew as time went on, how old the robots' map was, and how far
/// robots really were from what is sensed, which they know from the map alone.
/// @param spaces that the robots of this run had
void show_sensed(PagePlan& plan, const Team& team, const TeamRun& run, const SensedSpaces& spaces);

}  // namespace clearway
