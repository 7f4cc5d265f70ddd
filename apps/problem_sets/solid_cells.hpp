#pragma once

#include <vector>

#include "apps/problem_sets/problem_set.hpp"
#include "mapping/snapshot.hpp"

namespace clearway {

/// A map in which a voxel is occupied when a solid, or the surface of a mesh, meets it, and unknown else; but
/// for those of objects that links may touch.
/// Deterministic.
/// @param resolution m, edge of a voxel
/// @param[out] cells how many voxels each solid meets
/// @throws std::invalid_argument naming the world and the object with which more than 25,000,000 voxels would
///         have to be looked at, or for a resolution that is too fine.
Snapshot map_of_foreign_world(const ForeignWorld& world, double resolution, std::vector<std::size_t>& cells);

}  // namespace clearway
