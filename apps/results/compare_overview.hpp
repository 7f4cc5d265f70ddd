#pragma once

#include <cstddef>
#include <nlohmann/json_fwd.hpp>
#include <string>
#include <vector>

#include "apps/results/compare_results.hpp"

namespace clearway {

/// The planners of one label, over all experiments of single robots.
struct OverviewRow {
  ComparePlanner who;            ///< as in the first experiment; certified in all of them
  bool has_same_options = true;  ///< planner and options are the same in all of them
  std::size_t experiments = 0;   ///< in which it has runs
  bool is_comparable = false;    ///< it has all the runs that any planner has
  CompareSummary all;            ///< of all its runs
  CompareSummary shared;         ///< of its runs that all comparable planners solved with a valid path
};

/// All experiments of single robots added up. Sums of planners that did not run the same problems with the
/// same seeds say nothing against each other: only comparable rows do.
struct CompareOverview {
  std::size_t experiments = 0;        ///< with runs
  std::size_t without_runs = 0;       ///< experiments that nobody has begun
  std::size_t teams = 0;              ///< experiments of teams, which are not in it
  std::size_t runs = 0;               ///< problems and seeds that any planner ran
  std::size_t shared = 0;             ///< of these, that all comparable planners solved with a valid path
  std::string length_unit{};          ///< of all their paths: as of an experiment, else "rad or m"
  std::vector<OverviewRow> planners;  ///< comparable ones first, each in the order of the suite

  /// Whether a planner has runs in two experiments or more; else there is nothing to add up.
  bool adds_up() const;
};

CompareOverview overview(const CompareResults& results);

/// A header, then a row for each planner; a label that is not comparable ends in " *". Empty when nothing
/// adds up.
std::vector<std::vector<std::string>> overview_table(const CompareOverview& all);

/// What the table may be read for and what not, in sentences.
std::vector<std::string> overview_notes(const CompareOverview& all);

/// The same for `--json` and the page; null when nothing adds up.
nlohmann::ordered_json overview_json(const CompareOverview& all);

}  // namespace clearway
