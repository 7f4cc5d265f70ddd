#pragma once

#include <Eigen/Core>
#include <vector>

#include "mapping/snapshot.hpp"

namespace clearway {

/// The map with the voxels of these points free, because somebody says that nothing else is there: as if rays
/// had passed them, and with `is_painted` as if every volume had painted them, too. What is painted stays so:
/// a conflict becomes painted. `map` does not change, and the two share all other voxels. When the voxels
/// were last seen stays as it was.
/// @param points map frame; those that have no voxel (not finite, far away) are left out
Snapshot with_free_voxels(const Snapshot& map, const std::vector<Eigen::Vector3d>& points, bool is_painted);

}  // namespace clearway
