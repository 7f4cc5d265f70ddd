#pragma once

#include "mapping/voxels/fused_tree.hpp"

namespace clearway {

/// The deepest node that holds the ScanTile of a cell: its own, or a leaf above it. Null when nothing is
/// stored there.
inline const FusedNode* tile_node(const FusedTree& tree, const Eigen::Vector3i& cell) {
  const FusedNode* node = tree.getRoot();
  for (unsigned level = 15; node != nullptr && node->has_children() && level >= 5; --level) {
    const auto upper = [&](int axis) { return static_cast<unsigned>(cell[axis] + 32768) >> level & 1U; };
    node = node->child(upper(0) | upper(1) << 1U | upper(2) << 2U);
  }
  return node;
}

/// The leaf of a voxel of a ScanTile, by its bit; null when nothing is stored there.
inline const FusedNode* leaf_below(const FusedNode* tile, unsigned bit) {
  for (int level = 4; tile != nullptr && tile->has_children() && level >= 0; --level)
    tile = tile->child(bit >> 3 * level & 7U);
  return tile;
}

}  // namespace clearway
