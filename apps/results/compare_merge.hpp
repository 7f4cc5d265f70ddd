#pragma once

#include <filesystem>
#include <vector>

#include "apps/results/compare_records.hpp"

namespace clearway {

/// Joins the results of all shards of one comparison into those of one that was run whole: what they have
/// beside tables (plans, pages, maps) and the merged tables go into `folder`.
/// @param folders of results, one for each shard, in any order
/// @throws std::invalid_argument in one sentence: a shard that is missing, is given twice, was interrupted,
/// or is of another comparison; std::runtime_error when no shard has a problem, as the whole run has it
CompareResults merge_into(const std::filesystem::path& folder,
                          const std::vector<std::filesystem::path>& folders);

}  // namespace clearway
