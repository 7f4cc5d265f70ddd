// Painting: FusedTree's own descent. A node that `search` or `updateNode` returns may stand for many voxels,
// so painting never goes through those.

#include <bit>

#include "mapping/ball_table.hpp"

namespace clearway {

struct FusedTree::Brush {
  BallTable ball;
  std::uint16_t bit = 0;
  PaintTally tally;
};

PaintTally FusedTree::paint(int volume, const Sphere& ball) {
  Brush brush{{ball, resolution}, static_cast<std::uint16_t>(1U << volume), {}};
  const CellCube whole;
  if (!brush.ball.covers_some_voxel(whole)) return brush.tally;
  brush.tally.painted = brush.ball.count();
  bool created = false;
  FusedNode& top = root_for_writing(created);
  if (brush.ball.covers(whole)) {
    paint_all(top, created, whole, brush);
  } else {
    paint_cube(top, created, whole, brush);
  }
  return brush.tally;
}

/// True when painting changes nothing in the node and meets no occupied voxel, whatever part the ball covers.
bool FusedTree::is_painted_throughout(const FusedNode& node, std::uint16_t bit) const {
  return (node.painted() & bit) != 0 && state(node) != VoxelState::conflict;
}

/// Precondition: some voxel of the cube, but not all, lies wholly inside the ball. False when nothing
/// changed.
bool FusedTree::paint_cube(FusedNode& node, bool just_created, const CellCube& cube, Brush& brush) {
  const BallTable::Children covered = brush.ball.children(cube);
  bool changed = !node.has_children() && !just_created;  // split below: at least to be pruned again
  for (unsigned left = covered.some; left != 0; left &= left - 1) {
    const auto i = static_cast<unsigned>(std::countr_zero(left));
    const FusedNode* now = node.has_children() ? node.child(i) : nullptr;
    if (now != nullptr && is_painted_throughout(*now, brush.bit)) continue;
    bool created = false;
    FusedNode& child = child_for_writing(node, i, just_created, created);
    just_created = false;
    const bool all = (covered.all >> i & 1U) != 0;
    changed = (all ? paint_all(child, created, cube.child(i), brush)
                   : paint_cube(child, created, cube.child(i), brush)) ||
              changed;
  }
  if (changed && !pruneNode(&node)) node.updateOccupancyChildren();
  return changed;
}

/// Paints every voxel of the cube; voxels that were not stored become painted and unobserved. False when
/// nothing changed.
bool FusedTree::paint_all(FusedNode& node, bool just_created, const CellCube& cube, Brush& brush) {
  bool changed = false;
  if (!node.has_children()) {
    changed = (node.painted() & brush.bit) == 0;
    if (changed) brush.tally.newly += cube.volume();
    node.add_paint(brush.bit);
    if (just_created || state(node) != VoxelState::conflict) return changed;
    brush.tally.conflicts += cube.volume();
    if (changed) brush.tally.new_conflicts.push_back(cube);
    return changed;
  }
  for (unsigned i = 0; i < 8; ++i) {
    if (node.child(i) != nullptr && is_painted_throughout(*node.child(i), brush.bit)) continue;
    bool created = false;
    FusedNode& child = child_for_writing(node, i, false, created);
    changed = paint_all(child, created, cube.child(i), brush) || changed;
  }
  if (changed && !pruneNode(&node)) node.updateOccupancyChildren();
  return changed;
}

}  // namespace clearway
