#pragma once

#include "mapping/voxels/voxel_state.hpp"

namespace clearway {

class SeenStamps;

/// Refuses a `seen_within` that a map cannot answer.
/// @param seen of the map; null when it does not know when its voxels were seen
/// @throws std::invalid_argument when it is not >= 0 and finite, and, unless it is 0, when the map knows no
///         times or only longer periods.
void require_seen_within(double seen_within, const SeenStamps* seen);

/// The same, and an age under another policy than known_free: only that asks when a voxel was seen.
/// @throws std::invalid_argument
void require_seen_within(const Requirement& requirement, const SeenStamps* seen);

}  // namespace clearway
