// Erasing and undoing: FusedTree's descent that paints and unpaints until the voxels agree with a list of
// spheres again. Like painting it goes to single voxels, never through a node that stands for many.

#include <algorithm>

#include "mapping/voxels/sphere_cells.hpp"

namespace clearway {

namespace {

using Spheres = std::vector<const Sphere*>;

Spheres pointers(const std::vector<Sphere>& spheres) {
  Spheres result;
  result.reserve(spheres.size());
  for (const Sphere& sphere : spheres) result.push_back(&sphere);
  return result;
}

Spheres covering_some_voxel(const Spheres& spheres, const CellCube& cube, double resolution) {
  Spheres result;
  for (const Sphere* sphere : spheres) {
    if (covers_some_voxel(*sphere, cube, resolution)) result.push_back(sphere);
  }
  return result;
}

bool nothing_known(const FusedNode& node) {
  return !node.has_children() && !node.observed() && node.painted() == 0;
}

}  // namespace

/// The part of the work that lies in one cube.
struct FusedTree::Repainting {
  CellCube cube;
  Spheres changed;  ///< where voxels may have changed; of those that cover some voxel of the cube
  Spheres spheres;  ///< of the volume, likewise
  std::uint16_t bit = 0;
  RepaintTally* tally = nullptr;
};

RepaintTally FusedTree::repaint(int volume, const std::vector<Sphere>& changed,
                                const std::vector<Sphere>& spheres) {
  RepaintTally tally;
  const CellCube whole;
  const Spheres where = covering_some_voxel(pointers(changed), whole, resolution);
  if (where.empty()) return tally;
  const Repainting work{whole, where, covering_some_voxel(pointers(spheres), whole, resolution),
                        static_cast<std::uint16_t>(1U << volume), &tally};
  if (work.spheres.empty() && root == nullptr) return tally;
  bool created = false;
  FusedNode& top = root_for_writing(created);
  repaint_cube(top, created, work);
  if (nothing_known(top)) release_root();
  return tally;
}

/// Precondition: every voxel of the volume outside of the changed spheres agrees with the spheres.
void FusedTree::repaint_cube(FusedNode& node, bool just_created, const Repainting& work) {
  const auto covers_all = [&](const Sphere* sphere) { return covers(*sphere, work.cube, resolution); };
  if (work.spheres.empty()) return repaint_all(node, false, work.cube, work);
  if (std::any_of(work.spheres.begin(), work.spheres.end(), covers_all))
    return repaint_all(node, true, work.cube, work);
  for (unsigned i = 0; i < 8; ++i) {
    Repainting part{work.cube.child(i), {}, {}, work.bit, work.tally};
    part.changed = covering_some_voxel(work.changed, part.cube, resolution);
    if (part.changed.empty()) continue;
    part.spheres = covering_some_voxel(work.spheres, part.cube, resolution);
    if (part.spheres.empty() && !may_be_painted(node, i, just_created, work.bit)) continue;
    bool created = false;
    FusedNode& child = child_for_writing(node, i, just_created, created);
    repaint_cube(child, created, part);
    if (nothing_known(child)) remove_child(node, i);
    just_created = !node.has_children();
  }
  if (node.has_children() && !pruneNode(&node)) node.updateOccupancyChildren();
}

/// Puts the volume's paint on every voxel of the cube, or takes it off.
void FusedTree::repaint_all(FusedNode& node, bool paint, const CellCube& cube, const Repainting& work) {
  if (!node.has_children()) {
    const bool was_painted = (node.painted() & work.bit) != 0;
    if (was_painted != paint) (paint ? work.tally->painted : work.tally->unpainted) += cube.volume();
    paint ? node.add_paint(work.bit) : node.remove_paint(work.bit);
    return;
  }
  for (unsigned i = 0; i < 8; ++i) {
    if (!paint && !nodeChildExists(&node, i)) continue;
    bool created = false;
    FusedNode& child = child_for_writing(node, i, false, created);
    repaint_all(child, paint, cube.child(i), work);
    if (nothing_known(child)) remove_child(node, i);
  }
  if (node.has_children() && !pruneNode(&node)) node.updateOccupancyChildren();
}

/// False when no voxel of a child can carry the paint `bit`: nothing is stored for it, or a pruned `node`
/// says so for all.
bool FusedTree::may_be_painted(const FusedNode& node, unsigned index, bool just_created,
                               std::uint16_t bit) const {
  if (!node.has_children()) return !just_created && (node.painted() & bit) != 0;
  return nodeChildExists(&node, index);
}

void FusedTree::take_back(const Eigen::Vector3i& cell) {
  bool created = false;
  FusedNode& top = root_for_writing(created);
  take_back_below(top, static_cast<int>(tree_depth), cell);
  if (nothing_known(top)) release_root();
}

void FusedTree::take_back_below(FusedNode& node, int level, const Eigen::Vector3i& cell) {
  if (level == 0) return node.unobserve();
  const auto upper = [&](int axis) { return static_cast<unsigned>(cell[axis] + 32768) >> (level - 1) & 1U; };
  const unsigned index = upper(0) | upper(1) << 1U | upper(2) << 2U;
  bool created = false;
  FusedNode& child = child_for_writing(node, index, false, created);
  take_back_below(child, level - 1, cell);
  if (nothing_known(child)) remove_child(node, index);
  if (node.has_children() && !pruneNode(&node)) node.updateOccupancyChildren();
}

void FusedTree::free_voxel(const Eigen::Vector3i& cell, std::uint16_t volumes) {
  bool created = false;
  FusedNode& top = root_for_writing(created);
  set_below(top, created, static_cast<int>(tree_depth), cell, getClampingThresMinLog(), volumes);
}

void FusedTree::free_voxel_by_hand(const Eigen::Vector3i& cell) {
  bool created = false;
  FusedNode& top = root_for_writing(created);
  set_below(top, created, static_cast<int>(tree_depth), cell, by_hand_log_odds(), 0);
}

void FusedTree::occupy_voxel(const Eigen::Vector3i& cell) {
  bool created = false;
  FusedNode& top = root_for_writing(created);
  const float highest = std::max(getClampingThresMaxLog(), getOccupancyThresLog());
  set_below(top, created, static_cast<int>(tree_depth), cell, highest, 0);
}

void FusedTree::set_below(FusedNode& node, bool just_created, int level, const Eigen::Vector3i& cell,
                          float log_odds, std::uint16_t volumes) {
  if (level == 0) {
    node.observe(log_odds);
    return node.add_paint(volumes);
  }
  const auto upper = [&](int axis) { return static_cast<unsigned>(cell[axis] + 32768) >> (level - 1) & 1U; };
  bool created = false;
  FusedNode& child =
      child_for_writing(node, upper(0) | upper(1) << 1U | upper(2) << 2U, just_created, created);
  set_below(child, created, level - 1, cell, log_odds, volumes);
  if (!pruneNode(&node)) node.updateOccupancyChildren();
}

/// Takes a leaf away, and the child array with the last one.
void FusedTree::remove_child(FusedNode& node, unsigned index) {
  FusedNode::release(static_cast<FusedNode*>(node.children[index]));
  node.children[index] = nullptr;
  --tree_size;
  size_changed = true;
  for (unsigned i = 0; i < 8; ++i) {
    if (node.child(i) != nullptr) return;
  }
  node.drop_children();
  node.forget();
}

}  // namespace clearway
