#pragma once

#include <array>
#include <filesystem>
#include <string>
#include <vector>

#include "apps/results/compare_results.hpp"
#include "datasets/descriptions/query_fields.hpp"

namespace clearway {

/// Labels of planners as names of files (name_as_file), distinguished where they would be one.
std::vector<std::string> names_as_files(const std::vector<ComparePlanner>& planners);

/// What `--rerun` takes: EXPERIMENT/PROBLEM/LABEL, with several runs a problem -NUMBER, each part as a file.
std::string run_id(const CompareExperiment& experiment, const CompareProblem& problem, const CompareRun& run);

/// What every run reported, line by line (compare_records.hpp), in a folder of results.
constexpr const char* records_name = "runs.jsonl";

/// What save_results writes, and these lines.
inline constexpr std::array result_files = {"results.sqlite", "results.csv", "results.log", "report.html",
                                            records_name};

/// Whether a file of this name is written into a folder of results.
bool is_of_comparison(const std::filesystem::path& relative);

/// Database, CSV, OMPL's log and page, each replaced as a whole.
void save_results(const CompareResults& results, const std::filesystem::path& folder);

}  // namespace clearway
