#pragma once

#include <cstddef>
#include <nlohmann/json_fwd.hpp>
#include <string>
#include <vector>

#include "apps/results/compare_results.hpp"

namespace clearway {

/// A planner at each resolution of a sweep.
struct ResolutionRow {
  std::size_t planner = 0;             ///< index, the same in all of the experiments
  std::vector<CompareSummary> points;  ///< one for each resolution
};

/// Experiments that differ in their resolution alone (SuiteExperiment::alike), finest first.
struct ResolutionSweep {
  std::vector<std::size_t> experiments;  ///< indices
  std::vector<double> resolutions;       ///< m, of these, rising
  std::vector<ResolutionRow> planners;
  std::size_t same_problems = 0;  ///< with a start and goals that all of the experiments have
  std::size_t most_problems = 0;  ///< of the experiment that has most
};

/// Sweeps of two resolutions and more; experiments without runs are left out.
std::vector<ResolutionSweep> resolution_sweeps(const CompareResults& results);

/// A header, then a row for each planner and resolution.
std::vector<std::vector<std::string>> sweep_table(const CompareResults& results,
                                                  const ResolutionSweep& sweep);
/// "reach-0.01, reach-0.02".
std::string sweep_name(const CompareResults& results, const ResolutionSweep& sweep);
/// Whether the problems are the same at all resolutions, in a sentence.
std::string sweep_note(const ResolutionSweep& sweep);

/// All sweeps for `--json` and the page.
nlohmann::ordered_json sweeps_json(const CompareResults& results);

}  // namespace clearway
