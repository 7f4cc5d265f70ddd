#include "mapping/voxels/leaf_bounds.hpp"

#include <limits>

#include "mapping/voxels/fused_tree.hpp"

namespace clearway {
namespace {

/// How far stored leaves reach along an axis, up or down, in cells. Asks first where it may be farthest, so
/// that most of the tree cannot be farther.
struct Extent {
  int axis;
  bool up;
  int farthest = std::numeric_limits<int>::min();  ///< of the cubes' faces; negative numbers when down

  void extend(const FusedNode& node, const CellCube& cube) {
    const int face = up ? cube.corner[axis] + cube.edge : -cube.corner[axis];
    if (face <= farthest) return;
    if (!node.has_children()) {
      farthest = face;
      return;
    }
    const int middle = cube.corner[axis] + cube.edge / 2;
    for (const bool far : {true, false}) {
      if (!far && (up ? middle : -middle) <= farthest) return;
      for (unsigned i = 0; i < 8; ++i) {
        const bool is_upper = (i >> axis & 1U) != 0;
        if ((is_upper == up) != far) continue;
        if (const FusedNode* child = node.child(i)) extend(*child, cube.child(i));
      }
    }
  }
};

Eigen::AlignedBox3i box_of(const CellCube& cube) {
  return {cube.corner, cube.corner + Eigen::Vector3i::Constant(cube.edge)};
}

/// Two versions of a tree side by side.
struct Changes {
  Eigen::AlignedBox3i before;
  Eigen::AlignedBox3i bounds = before;  ///< with what came
  bool may_be_smaller = false;          ///< leaves went that touched the bounds

  void follow(const FusedNode* was, const FusedNode* now, const CellCube& cube) {
    if (was == now || may_be_smaller) return;
    if (now == nullptr) {
      const Eigen::AlignedBox3i gone = box_of(cube).intersection(before);
      may_be_smaller = (gone.min().array() == before.min().array()).any() ||
                       (gone.max().array() == before.max().array()).any();
      return;
    }
    if (!now->has_children()) {
      bounds.extend(box_of(cube));
      return;
    }
    const bool split = was != nullptr && was->has_children();  // else a leaf stands for all of its parts
    for (unsigned i = 0; i < 8; ++i) follow(split ? was->child(i) : was, now->child(i), cube.child(i));
  }
};

}  // namespace

Eigen::AlignedBox3i leaf_bounds(const FusedTree& tree) {
  Eigen::AlignedBox3i bounds;
  const FusedNode* root = tree.getRoot();
  if (root == nullptr) return bounds;
  for (int axis = 0; axis < 3; ++axis) {
    Extent down{axis, false}, up{axis, true};
    down.extend(*root, CellCube{});
    up.extend(*root, CellCube{});
    bounds.min()[axis] = -down.farthest;
    bounds.max()[axis] = up.farthest;
  }
  return bounds;
}

Eigen::AlignedBox3i leaf_bounds(const FusedTree& tree, const FusedTree& before,
                                const Eigen::AlignedBox3i& bounds_before) {
  Changes changes{bounds_before};
  changes.follow(before.getRoot(), tree.getRoot(), CellCube{});
  return changes.may_be_smaller ? leaf_bounds(tree) : changes.bounds;
}

}  // namespace clearway
