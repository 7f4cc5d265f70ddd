#pragma once

#include <Eigen/Core>
#include <string>
#include <vector>

#include "mapping/snapshot.hpp"

namespace clearway {

// Maps that somebody changes by hand, and what they say of it. `map` does not change, and shares all other
// voxels with the result, whose record (FusedTree::hand_edits) counts the voxels that changed.

/// What an edit did, in voxels, by the states that they have now.
struct HandEditTally {
  std::size_t occupied = 0, conflict = 0;  ///< that were not occupied before
  std::size_t seen_free = 0, painted = 0;  ///< that were occupied, or that nobody had observed
};

/// The map with the voxels of these points occupied, as sure as the map can be: painted ones are conflicts.
/// @param points map frame; those that have no voxel are left out
Snapshot with_occupied_voxels(const Snapshot& map, const std::vector<Eigen::Vector3d>& points,
                              HandEditTally& tally);

/// The map with the voxels of these points seen free, as with_free_voxels does it: paint stays, so a conflict
/// becomes painted, and when they were last seen stays as it was, so that voxels that no sensor saw count as
/// too old where an age is asked for.
Snapshot with_cleared_voxels(const Snapshot& map, const std::vector<Eigen::Vector3d>& points,
                             HandEditTally& tally);

/// "the map was edited by hand: 12 voxels made occupied, 40 voxels made free", and the same of what a crop
/// cut off; empty for any other map. Known of maps in our own .ot files and of what is made of them.
std::string hand_edit_caveat(const Snapshot& map);

}  // namespace clearway
