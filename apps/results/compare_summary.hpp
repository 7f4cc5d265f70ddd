#pragma once

#include <cstddef>
#include <nlohmann/json_fwd.hpp>

#include "apps/results/compare_results.hpp"

namespace clearway {

/// The summary of a planner as `--json` prints it and as the page reads it; keys end in their units, and what
/// does not exist is null: medians of nothing, and what only teams have.
nlohmann::ordered_json summary_json(const CompareExperiment& experiment, std::size_t planner);

/// The same of any runs of single robots.
nlohmann::ordered_json summary_json(const ComparePlanner& who, const CompareSummary& sum);

}  // namespace clearway
