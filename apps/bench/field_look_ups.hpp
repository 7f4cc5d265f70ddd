#pragma once

#include "apps/bench/page/result.hpp"
#include "apps/bench/peers/both_fields.hpp"

namespace clearway::bench {

/// Look-ups per second of both fields: single points against single points, and our batches, which
/// dynamicEDT3D has not. Into `detail` and as tables.
std::vector<Table> look_up_tables(const BlockedField& ours, const DynamicEDTOctomap& theirs, int runs,
                                  nlohmann::ordered_json& detail);

/// How far each answer is from the exact distance to the nearest blocked cube, and how often it is too large.
Table error_table(const BlockedField& ours, const DynamicEDTOctomap& theirs, nlohmann::ordered_json& detail);

}  // namespace clearway::bench
