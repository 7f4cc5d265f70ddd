#pragma once

#include <Eigen/Geometry>

namespace clearway {

class FusedTree;

/// The cells from the lowest corner of any stored leaf's cube to the highest one (exclusive); empty for an
/// empty tree. Cells as in CellCube.
Eigen::AlignedBox3i leaf_bounds(const FusedTree& tree);

/// The same from those of an earlier version: reads only what the two versions do not share, unless leaves
/// went that bounded it.
Eigen::AlignedBox3i leaf_bounds(const FusedTree& tree, const FusedTree& before,
                                const Eigen::AlignedBox3i& bounds_before);

}  // namespace clearway
