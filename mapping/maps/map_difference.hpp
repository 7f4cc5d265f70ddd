#pragma once

#include <cstddef>
#include <map>
#include <string>
#include <utility>
#include <vector>

#include "mapping/snapshot.hpp"

namespace clearway {

/// How two maps differ; counts are voxels.
struct MapDifference {
  bool resolution = false;           ///< the voxels are of different size, and so not compared
  bool threshold = false;            ///< occupied from another probability on
  std::vector<std::string> volumes;  ///< labels that are in one only, or differ in parts or spheres
  std::map<std::pair<VoxelState, VoxelState>, std::size_t> states;  ///< that differ: (here, there)
  std::size_t evidence = 0;  ///< of the same state, but with other log-odds, observed or not, other volumes

  bool any() const { return resolution || threshold || evidence > 0 || !volumes.empty() || !states.empty(); }
};

/// Compares voxel by voxel, paint by the volumes' labels. Spheres are compared as lists.
MapDifference difference(const Snapshot& map, const Snapshot& other);

}  // namespace clearway
