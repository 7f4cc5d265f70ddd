// Painting: FusedTree's own descent. A node that `search` or `updateNode` returns may stand for many voxels,
// so painting never goes through those. What sensors say stays as it is everywhere, inner nodes included.

#include <bit>

#include "mapping/voxels/sphere_table.hpp"

namespace clearway {
namespace {

/// Unobserved, and painted by this volume alone.
bool holds_only_paint(const FusedNode& node, std::uint16_t bit) {
  return !node.has_children() && !node.observed() && node.painted() == bit;
}

}  // namespace

/// One sphere on its way through one tree.
struct FusedTree::Brush {
  using Children = SphereTable::Children;

  const FusedTree& tree;
  const SphereTable sphere;
  const std::uint16_t bit;
  std::size_t& nodes;  ///< of the tree, counted
  PaintTally tally{};
  const FusedNode nothing{};

  /// Bit i: child i is stored; it is painted throughout and holds no conflict, so there is nothing to do.
  struct Stored {
    unsigned any = 0, done = 0;
  };
  void paint_new(FusedNode& leaf, const CellCube& cube);
  void paint_in_new(FusedNode& node, const CellCube& cube);
  bool paint_all(FusedNode& node, const CellCube& cube);
  bool paint_some(FusedNode& node, const CellCube& cube);
  bool paint_children(FusedNode& node, const CellCube& cube, const Children& covered);
  bool paint_stored(FusedNode& node, const CellCube& cube, const Children& covered, unsigned stored);
  void paint_missing(FusedNode& node, const CellCube& cube, const Children& covered, unsigned missing);
  Stored look_at_children(const FusedNode& node) const;
  void settle(FusedNode& node);
};

PaintTally FusedTree::paint(int volume, const Sphere& sphere) {
  Brush brush{*this, {sphere, resolution}, static_cast<std::uint16_t>(1U << volume), tree_size};
  const CellCube whole;
  if (!brush.sphere.covers_some_voxel(whole)) return brush.tally;
  brush.tally.painted = brush.sphere.count();
  bool created = false;
  FusedNode& top = root_for_writing(created);
  const bool all = brush.sphere.covers(whole);
  if (created) {
    all ? brush.paint_new(top, whole) : brush.paint_in_new(top, whole);
  } else {
    all ? brush.paint_all(top, whole) : brush.paint_some(top, whole);
  }
  size_changed = true;
  return brush.tally;
}

/// A leaf of which nothing was stored: painted, and unobserved.
void FusedTree::Brush::paint_new(FusedNode& leaf, const CellCube& cube) {
  leaf.add_paint(bit);
  tally.newly += cube.volume();
}

/// What the sphere covers of a cube of which nothing was stored: some of it, but not all. So inner nodes are
/// as new ones are, and there is nothing to prune.
void FusedTree::Brush::paint_in_new(FusedNode& node, const CellCube& cube) {
  const Children covered = sphere.children(cube);
  paint_missing(node, cube, covered, covered.some);
}

/// Creates covered children.
void FusedTree::Brush::paint_missing(FusedNode& node, const CellCube& cube, const Children& covered,
                                     unsigned missing) {
  const std::size_t part = cube.volume() / 8;
  for (; missing != 0; missing &= missing - 1) {
    const auto i = static_cast<unsigned>(std::countr_zero(missing));
    bool created = false;
    FusedNode& child = node.child_for_writing(i, true, created, nodes);
    if ((covered.all >> i & 1U) != 0) {
      child.add_paint(bit);
      tally.newly += part;
    } else {
      paint_in_new(child, cube.child(i));
    }
  }
}

/// Every voxel of a stored node. False when nothing changed.
bool FusedTree::Brush::paint_all(FusedNode& node, const CellCube& cube) {
  if (node.has_children()) return paint_children(node, cube, {0xff, 0xff});
  const bool changed = (node.painted() & bit) == 0;
  if (changed) paint_new(node, cube);
  if (tree.state(node) != VoxelState::conflict) return changed;
  tally.conflicts += cube.volume();
  if (changed) tally.new_conflicts.push_back(cube);
  return changed;
}

/// What the sphere covers of a stored node: some of it, but not all. False when nothing changed.
bool FusedTree::Brush::paint_some(FusedNode& node, const CellCube& cube) {
  const Children covered = sphere.children(cube);
  if (node.has_children()) return paint_children(node, cube, covered);
  bool created = false;
  node.child_for_writing(0, false, created, nodes);  // all eight, each as the node was
  const bool changed = paint_children(node, cube, covered);
  if (!changed) node.prune(nodes);
  return changed;
}

/// The covered children of a node that has some. False when nothing changed.
bool FusedTree::Brush::paint_children(FusedNode& node, const CellCube& cube, const Children& covered) {
  const Stored stored = look_at_children(node);
  const bool changed = paint_stored(node, cube, covered, covered.some & stored.any & ~stored.done);
  const unsigned missing = covered.some & ~stored.any;
  if (missing == 0) {
    if (changed) settle(node);
    return changed;
  }
  bool all_alike = (stored.any | (covered.all & missing)) == 0xff;  // no need to make all eight for pruning
  for (unsigned rest = stored.any; rest != 0; rest &= rest - 1)
    all_alike =
        all_alike && holds_only_paint(*node.child(static_cast<unsigned>(std::countr_zero(rest))), bit);
  if (all_alike) {
    tally.newly += static_cast<std::size_t>(std::popcount(missing)) * (cube.volume() / 8);
    nodes -= static_cast<std::size_t>(std::popcount(stored.any));
    node.drop_children();
    node.add_paint(bit);
    return true;
  }
  paint_missing(node, cube, covered, missing);
  settle(node);
  return true;
}

/// Without a branch to guess wrong.
FusedTree::Brush::Stored FusedTree::Brush::look_at_children(const FusedNode& node) const {
  Stored stored;
#pragma GCC unroll 8
  for (unsigned i = 0; i < 8; ++i) {
    const FusedNode* child = node.child(i);
    const bool is_stored = child != nullptr;
    child = is_stored ? child : &nothing;
    const bool is_occupied = child->observed() & tree.isNodeOccupied(child);
    const bool is_done = ((child->painted() & bit) != 0) & !is_occupied;
    stored.any |= static_cast<unsigned>(is_stored) << i;
    stored.done |= static_cast<unsigned>(is_done) << i;
  }
  return stored;
}

/// Those of the covered children that `stored` names. False when nothing changed.
bool FusedTree::Brush::paint_stored(FusedNode& node, const CellCube& cube, const Children& covered,
                                    unsigned stored) {
  bool changed = false;
  for (; stored != 0; stored &= stored - 1) {
    const auto i = static_cast<unsigned>(std::countr_zero(stored));
    bool created = false;
    FusedNode& child = node.child_for_writing(i, false, created, nodes);
    const bool all = (covered.all >> i & 1U) != 0;
    if (all ? paint_all(child, cube.child(i)) : paint_some(child, cube.child(i))) changed = true;
  }
  return changed;
}

/// Prunes or updates a node some of whose children were painted.
void FusedTree::Brush::settle(FusedNode& node) {
  for (unsigned i = 0; i < 8; ++i) {
    if (node.child(i) == nullptr || (node.child(i)->painted() & bit) == 0) return;
  }
  if (!node.prune(nodes)) node.add_paint(bit);
}

}  // namespace clearway
