#pragma once

#include "apps/compare/compare_run.hpp"
#include "apps/console/console.hpp"

namespace clearway {

/// Draws the pages in 3D of an experiment's worst runs (compare_worst.hpp) below `choice.out`, at most
/// `choice.worst_pages` of them. Its maps are made once more, in a process of its own; what
/// cannot be drawn is warned of and left out. None for teams, which have pages of their own.
/// @param index of the experiment in `records`, which has its runs
void draw_worst_pages(const Suite& suite, const PreparedExperiment& experiment, std::size_t index,
                      const CompareChoice& choice, const CompareRecords& records, Console& console);

}  // namespace clearway
