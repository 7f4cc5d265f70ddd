#pragma once

#include <nlohmann/json.hpp>

#include "apps/bench/worlds/noise_laws.hpp"

namespace clearway::bench {

/// Ghosts: voxels that a spurious return blocks though nothing solid comes into them. A camera stays in one
/// place of the furnished room and looks again and again, each time with new noise and new errors of its
/// pose; all goes into one map in safe integration.
/// @return how many ghosts a million rays make, for how many later looks each lasts (a look is a scan that
///         lowers the voxel's log-odds), and how many are there at the end; all of them, and those in the
///         open, farther than two bands from every solid
nlohmann::ordered_json watch_ghosts(const NoiseLaw& law, double resolution);

}  // namespace clearway::bench
