#pragma once

#include <cstddef>
#include <filesystem>
#include <string>
#include <vector>

#include "apps/results/compare_results.hpp"

namespace clearway {

/// A run of single robots that is the worst of its planner in one respect.
struct WorstCase {
  enum Kind {
    failed,    ///< without a valid path, after the longest time
    slowest,   ///< of the valid ones
    tightest,  ///< the valid path that comes nearest to what blocks, by the check
    dearest    ///< the valid path that costs most against the best of any planner to that problem
  } kind;
  std::size_t problem, run;  ///< indices in CompareExperiment::problems and its runs
  double badness;            ///< the larger the worse, among those of its kind
};
const char* to_string(WorstCase::Kind kind);

/// Planner by planner, kind by kind; of equal ones the first. None for teams.
std::vector<WorstCase> worst_cases(const CompareExperiment& experiment);

/// A problem with a seed whose page in 3D is worth drawing.
struct WorstPage {
  std::size_t problem;  ///< index
  int number;           ///< of the runs
};

/// Those of the worst cases, each once, at most so many: first the worst of each kind, whoever planned them,
/// then planner by planner. Problems that have a page of these runs already are left out.
std::vector<WorstPage> worst_pages(const CompareExperiment& experiment, std::size_t most);

/// Below the folder of results: worst/EXPERIMENT/PROBLEM[-NUMBER].html, whoever planned.
std::filesystem::path worst_page_file(const CompareExperiment& experiment, const CompareProblem& problem,
                                      int number);

/// Gives each worst run the name of its page (CompareRun::page) where there is one below `folder`, opened at
/// its plan.
void link_worst_pages(const std::filesystem::path& folder, CompareExperiment& experiment);

}  // namespace clearway
