#pragma once

#include "mapping/fused_tree.hpp"
#include "mapping/scan.hpp"

namespace clearway {

/// Carves the rays of one scan into the tree with OctoMap's own traversal: within the scan every voxel is
/// updated once, and a voxel in which any ray ends is occupied even where others pass (as computeUpdate).
/// A point beyond max_range frees its ray up to that range and sets no hit. With `discretize` one ray is cast
/// per end voxel, to its centre (as computeDiscreteUpdate).
/// @throws std::invalid_argument for a filter that makes no sense (see filter_points).
ScanCounts insert_scan(FusedTree& tree, const Scan& scan, const ScanFilter& filter, bool discretize);

}  // namespace clearway
