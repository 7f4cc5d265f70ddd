#pragma once

#include <functional>
#include <vector>

#include "apps/pages/voxel_faces.hpp"
#include "mapping/files/map_leaves.hpp"

namespace clearway {

/// The most faces of one state that a page shows: a browser without a graphics card draws as many.
inline constexpr std::uint64_t most_faces_shown = 600'000;

/// The voxels of each state but unknown, in cells as coarse as `most_faces` ask for: painted and seen free
/// where all of a cell is, so that nothing looks free that is not; occupied and conflict where any of it is.
/// Memory follows the surface, not the number of voxels.
/// @param shows_difference the states stand for changes: each is drawn where any voxel has it
/// @param also is called with each leaf on the way, unless it is empty
std::vector<PageVoxels> drawn_voxels(const MapLeaves& map, std::uint64_t most_faces = most_faces_shown,
                                     bool shows_difference = false,
                                     const std::function<void(const MapLeaf&)>& also = {});

}  // namespace clearway
