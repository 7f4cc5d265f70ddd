#pragma once

#include <nlohmann/json_fwd.hpp>
#include <string>

#include "apps/results/compare_results.hpp"

namespace clearway {

// What a comparison asks and finds as JSON, there and back: what workers send, what `runs.jsonl` holds, and
// what shards are merged from. Doubles come back bit for bit; those that are not finite are texts. Readers
// throw nlohmann::json::exception, or std::invalid_argument, for anything that was not written so.

nlohmann::ordered_json record_of(const CompareRun& run);
CompareRun run_of_record(const nlohmann::ordered_json& record);

/// Without its runs.
nlohmann::ordered_json record_of(const CompareProblem& problem);
CompareProblem problem_of_record(const nlohmann::ordered_json& record);

/// What tables, pages and the database show of an experiment, without problems and profiles.
nlohmann::ordered_json record_of(const CompareExperiment& experiment);
CompareExperiment experiment_of_record(const nlohmann::ordered_json& record);

/// Suite, machine and date, with which every JSON of results begins.
nlohmann::ordered_json head_of(const CompareResults& results);

/// The same and what the maps are like, without experiments.
nlohmann::ordered_json record_of(const CompareResults& results);
CompareResults results_of_record(const nlohmann::ordered_json& record);

}  // namespace clearway
