// Painting: FusedTree's own descent. A node that `search` or `updateNode` returns may stand for many voxels,
// so painting never goes through those.

#include <algorithm>
#include <array>
#include <cmath>

#include "mapping/fused_tree.hpp"

namespace clearway {

struct FusedTree::Brush {
  Sphere ball;
  std::uint16_t bit = 0;
  double resolution = 0.0;
  PaintTally tally;

  /// Squared distance from the ball's centre to the farthest corner of a cube.
  double farthest_corner_squared(const CellCube& cube) const {
    double sum = 0.0;
    for (int axis = 0; axis < 3; ++axis) {
      const double low = std::abs(cube.corner[axis] * resolution - ball.center[axis]);
      const double high = std::abs((cube.corner[axis] + cube.edge) * resolution - ball.center[axis]);
      const double far = std::max(low, high);
      sum += far * far;
    }
    return sum;
  }

  bool covers(const CellCube& cube) const {
    return farthest_corner_squared(cube) <= ball.radius * ball.radius;
  }

  /// True when at least one voxel of the cube lies wholly inside the ball. The voxel with the nearest
  /// farthest corner is, axis by axis, the one whose centre is nearest.
  bool covers_some_voxel(const CellCube& cube) const {
    CellCube voxel;
    voxel.edge = 1;
    for (int axis = 0; axis < 3; ++axis) {
      const double cell = std::floor(ball.center[axis] / resolution);
      voxel.corner[axis] =
          static_cast<int>(std::clamp(cell, static_cast<double>(cube.corner[axis]),
                                      static_cast<double>(cube.corner[axis] + cube.edge - 1)));
    }
    return covers(voxel);
  }
};

PaintTally FusedTree::paint(int volume, const Sphere& ball) {
  Brush brush{ball, static_cast<std::uint16_t>(1U << volume), resolution, {}};
  const CellCube whole;
  if (!brush.covers_some_voxel(whole)) return brush.tally;
  bool created = false;
  FusedNode& top = root_for_writing(created);
  paint_cube(top, created, whole, brush);
  return brush.tally;
}

/// Precondition: some voxel of the cube lies wholly inside the ball.
void FusedTree::paint_cube(FusedNode& node, bool just_created, const CellCube& cube, Brush& brush) {
  if (brush.covers(cube)) return paint_all(node, just_created, cube, brush);
  for (unsigned i = 0; i < 8; ++i) {
    const CellCube part = cube.child(i);
    if (!brush.covers_some_voxel(part)) continue;
    bool created = false;
    FusedNode& child = child_for_writing(node, i, just_created, created);
    paint_cube(child, created, part, brush);
    just_created = false;
  }
  if (!pruneNode(&node)) node.updateOccupancyChildren();
}

/// Paints every voxel of the cube; voxels that were not stored become painted and unobserved.
void FusedTree::paint_all(FusedNode& node, bool just_created, const CellCube& cube, Brush& brush) {
  if (!nodeHasChildren(&node)) {
    const std::size_t voxels = cube.volume();
    brush.tally.painted += voxels;
    if ((node.painted() & brush.bit) == 0) brush.tally.newly += voxels;
    node.add_paint(brush.bit);
    if (!just_created && state(node) == VoxelState::conflict) brush.tally.conflicts += voxels;
    return;
  }
  for (unsigned i = 0; i < 8; ++i) {
    bool created = false;
    FusedNode& child = child_for_writing(node, i, false, created);
    paint_all(child, created, cube.child(i), brush);
  }
  if (!pruneNode(&node)) node.updateOccupancyChildren();
}

}  // namespace clearway
