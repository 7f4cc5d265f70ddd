#pragma once

#include "mapping/voxels/fused_tree.hpp"

namespace clearway {

/// Calls `visit(const FusedNode* a, const FusedNode* b, const CellCube&)` for cubes that cover everything
/// that is stored in either of two trees of equal resolution; each is a leaf, or null for "nothing stored".
template <class Visit>
void visit_leaf_pairs(const FusedNode* a, const FusedNode* b, const CellCube& cube, const Visit& visit) {
  if (a == nullptr && b == nullptr) return;
  const bool split_a = a != nullptr && a->has_children(), split_b = b != nullptr && b->has_children();
  if (!split_a && !split_b) return visit(a, b, cube);
  for (unsigned i = 0; i < 8; ++i)
    visit_leaf_pairs(split_a ? a->child(i) : a, split_b ? b->child(i) : b, cube.child(i), visit);
}

template <class Visit>
void visit_leaf_pairs(const FusedTree& a, const FusedTree& b, const Visit& visit) {
  visit_leaf_pairs(a.getRoot(), b.getRoot(), CellCube{}, visit);
}

}  // namespace clearway
