#pragma once

#include <functional>
#include <nlohmann/json.hpp>

#include "datasets/simulation/room.hpp"
#include "mapping/voxels/voxel_state.hpp"

namespace clearway::bench {

using StateAt = std::function<VoxelState(const Eigen::Vector3d&)>;

/// 0 of nothing.
double share(std::size_t part, std::size_t whole);

/// Two maps against the truth, on random voxels of the room.
/// @return the share of the truly free voxels that are free in `peer` and in `ours`, too; and for each map
///         the shares of solid and surface voxels that it frees, and of free ones that it blocks
nlohmann::ordered_json compare_with_truth(const FurnishedRoom& room, double resolution, const StateAt& ours,
                                          const StateAt& peer);

}  // namespace clearway::bench
