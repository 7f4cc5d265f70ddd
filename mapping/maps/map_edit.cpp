#include "mapping/maps/map_edit.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>
#include <stdexcept>
#include <string>
#include <tuple>

#include "mapping/history/paint_log.hpp"
#include "mapping/stamps/seen_stamps.hpp"
#include "mapping/system/number_text.hpp"
#include "mapping/system/plain_text.hpp"
#include "mapping/system/require.hpp"
#include "mapping/voxels/fused_tree.hpp"
#include "mapping/voxels/leaf_pairs.hpp"

namespace clearway {
namespace {

/// An empty tree with the sensor model and threshold of another.
std::shared_ptr<FusedTree> empty_like(const FusedTree& tree, double resolution) {
  auto result = std::make_shared<FusedTree>(tree);
  result->clear();
  result->setResolution(resolution);
  return result;
}

// ---- merging

/// The spheres in the order of their times, so that it does not matter which map came first.
void put_in_order(PaintedVolume& volume) {
  volume.times.resize(volume.spheres.size(), 0.0);
  volume.stroke_of.resize(volume.spheres.size(), -1);
  std::vector<std::size_t> order(volume.spheres.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  const auto key = [&](std::size_t i) {
    const Sphere& sphere = volume.spheres[i];
    return std::tuple(volume.times[i], sphere.center.x(), sphere.center.y(), sphere.center.z(),
                      sphere.radius);
  };
  std::stable_sort(order.begin(), order.end(), [&](auto i, auto j) { return key(i) < key(j); });
  PaintedVolume ordered{volume.label, volume.critical_parts};
  ordered.strokes = volume.strokes;
  for (const std::size_t i : order) ordered.add(volume.spheres[i], volume.times[i], volume.stroke_of[i]);
  volume = std::move(ordered);
}

/// "the critical parts hand, tool", for a sentence.
std::string parts_of(const PaintedVolume& volume) {
  return volume.critical_parts.empty() ? "no critical parts"
                                       : "the critical parts " + listed(volume.critical_parts);
}

/// Adds the volumes of `others` to `volumes`; returns which volume each of them became.
std::vector<std::size_t> merge_volumes(std::vector<PaintedVolume>& volumes,
                                       const std::vector<PaintedVolume>& others) {
  std::vector<std::size_t> places;
  for (const PaintedVolume& other : others) {
    const auto same = [&](const PaintedVolume& volume) { return volume.label == other.label; };
    const auto found = std::find_if(volumes.begin(), volumes.end(), same);
    places.push_back(static_cast<std::size_t>(found - volumes.begin()));
    if (found == volumes.end()) {
      volumes.push_back(other);
      continue;
    }
    require(found->critical_parts == other.critical_parts,
            "merge: volume " + quote(other.label) + " has " + parts_of(*found) + " in one map and " +
                parts_of(other) + " in the other, expected the same");
    const auto strokes = static_cast<int>(found->strokes.size());
    const std::vector<Sphere> known = found->spheres;
    found->strokes.insert(found->strokes.end(), other.strokes.begin(), other.strokes.end());
    for (std::size_t i = 0; i < other.spheres.size(); ++i) {
      const Sphere& sphere = other.spheres[i];
      const auto is_sphere = [&](const Sphere& b) {
        return b.center == sphere.center && b.radius == sphere.radius;
      };
      if (std::any_of(known.begin(), known.end(), is_sphere)) continue;
      const int stroke = i < other.stroke_of.size() ? other.stroke_of[i] : -1;
      found->add(sphere, i < other.times.size() ? other.times[i] : 0.0, stroke < 0 ? -1 : strokes + stroke);
    }
  }
  require(volumes.size() <= static_cast<std::size_t>(FusedTree::volume_limit),
          "merge: the two maps have " + std::to_string(volumes.size()) +
              " painted volumes together, at most 15 are possible");
  return places;
}

std::shared_ptr<const SeenStamps> later_looks(const Snapshot& map, const Snapshot& other) {
  const SeenStamps none;
  const SeenStamps& first = map.seen() != nullptr ? *map.seen() : none;
  const SeenStamps& second = other.seen() != nullptr ? *other.seen() : none;
  return std::make_shared<const SeenStamps>(SeenStamps::later(first, second));
}

std::uint16_t moved(std::uint16_t mask, const std::vector<std::size_t>& places) {
  unsigned result = 0;
  for (std::size_t v = 0; v < places.size(); ++v) result |= (mask >> v & 1U) << places[v];
  return static_cast<std::uint16_t>(result);
}

/// Log-odds of a voxel that both maps observed: the higher ones where either calls it occupied, else the
/// lower ones.
float merged_log_odds(const FusedTree& tree, const FusedNode& a, const FusedNode& b) {
  const float higher = std::max(a.getLogOdds(), b.getLogOdds());
  return higher >= tree.getOccupancyThresLog() ? higher : std::min(a.getLogOdds(), b.getLogOdds());
}

}  // namespace

Snapshot merge(const Snapshot& map, const Snapshot& other) {
  const FusedTree &first = map.tree(), &second = other.tree();
  require(map.resolution() == other.resolution(), "merge: the maps have voxels of " +
                                                      to_text(map.resolution()) + " m and " +
                                                      to_text(other.resolution()) + " m, expected the same");
  require(first.getOccupancyThresLog() == second.getOccupancyThresLog(),
          "merge: the maps have different occupancy thresholds, expected the same");
  std::vector<PaintedVolume> volumes = map.volumes();
  std::vector<std::size_t> places = merge_volumes(volumes, other.volumes());
  for (PaintedVolume& volume : volumes) put_in_order(volume);
  for (std::size_t v = places.size(); v < 16; ++v) places.push_back(v);  // of a bare tree: as they are
  const auto tree = empty_like(first, map.resolution());
  tree->set_integration(of_both(first.integration(), second.integration()));
  tree->add_agreement(second.agreement());
  tree->add_hand_edits(second.hand_edits());
  if (const auto records = second.records_before_damage())
    tree->set_records_before_damage(*records + first.records_before_damage().value_or(0));
  visit_leaf_pairs(first, second, [&](const FusedNode* a, const FusedNode* b, const CellCube& cube) {
    FusedNode merged;
    for (const FusedNode* node : {a, b}) {
      if (node != nullptr && node->observed()) merged.observe(node->getLogOdds());
    }
    if (a != nullptr && b != nullptr && a->observed() && b->observed())
      merged.observe(merged_log_odds(first, *a, *b));
    if (a != nullptr) merged.add_paint(a->painted());
    if (b != nullptr) merged.add_paint(moved(b->painted(), places));
    tree->set_leaf(cube, merged);
  });
  tree->finish();
  return {tree, std::move(volumes), later_looks(map, other)};
}

Snapshot without_times(const Snapshot& map) {
  return {std::make_shared<const FusedTree>(map.tree()), map.volumes()};
}

Snapshot with_painted(const Snapshot& map, const std::vector<PaintedVolume>& added) {
  for (const PaintedVolume& volume : added) {
    require_storable(volume.label, volume.critical_parts);
    for (std::size_t i = 0; i < volume.spheres.size(); ++i)
      require_paintable(volume.spheres[i], i < volume.times.size() ? volume.times[i] : 0.0, map.resolution());
  }
  std::vector<PaintedVolume> volumes = map.volumes();
  const std::vector<std::size_t> places = merge_volumes(volumes, added);
  const auto tree = std::make_shared<FusedTree>(map.tree());
  for (std::size_t v = 0; v < added.size(); ++v)
    for (const Sphere& sphere : added[v].spheres) tree->paint(static_cast<int>(places[v]), sphere);
  return {tree, std::move(volumes), map.seen() ? std::make_shared<const SeenStamps>(*map.seen()) : nullptr};
}

// ---- cropping

namespace {

/// Cells first..last of a box snapped outwards; a side that lies on a border of voxels stays there.
std::pair<Eigen::Vector3i, Eigen::Vector3i> cells_of(const Eigen::AlignedBox3d& box, double resolution) {
  constexpr double slack = 1e-6;
  const auto cell = [](double value) { return static_cast<int>(std::clamp(value, -32768.0, 32767.0)); };
  Eigen::Vector3i first, last;
  for (int axis = 0; axis < 3; ++axis) {
    first[axis] = cell(std::floor(box.min()[axis] / resolution + slack));
    last[axis] = cell(std::ceil(box.max()[axis] / resolution - slack) - 1.0);
  }
  return {first, last};
}

void crop_below(const FusedNode& node, const CellCube& cube, const Eigen::Vector3i& first,
                const Eigen::Vector3i& last, FusedTree& result) {
  const Eigen::Array3i low = cube.corner.array(), high = low + (cube.edge - 1);
  if ((low > last.array()).any() || (high < first.array()).any()) return;
  const bool inside = (low >= first.array()).all() && (high <= last.array()).all();
  if (!node.has_children() && inside) return result.set_leaf(cube, node);
  for (unsigned i = 0; i < 8; ++i) {
    if (node.has_children() && node.child(i) == nullptr) continue;
    crop_below(node.has_children() ? *node.child(i) : node, cube.child(i), first, last, result);
  }
}

/// The volume with the spheres that reach the box.
PaintedVolume cropped(const PaintedVolume& volume, const Eigen::AlignedBox3d& box) {
  PaintedVolume result{volume.label, volume.critical_parts};
  result.strokes = volume.strokes;
  for (std::size_t i = 0; i < volume.spheres.size(); ++i) {
    const Sphere& sphere = volume.spheres[i];
    if (box.squaredExteriorDistance(sphere.center) > sphere.radius * sphere.radius) continue;
    result.add(sphere, i < volume.times.size() ? volume.times[i] : 0.0,
               i < volume.stroke_of.size() ? volume.stroke_of[i] : -1);
  }
  return result;
}

}  // namespace

namespace {

std::uint64_t occupied_voxels(const FusedTree& tree) {
  std::uint64_t count = 0;
  tree.visit_leaves([&](const FusedNode& node, const CellCube& cube) {
    if (node.observed() && tree.isNodeOccupied(node)) count += cube.volume();
  });
  return count;
}

}  // namespace

Snapshot crop(const Snapshot& map, const Eigen::AlignedBox3d& box) {
  require(box.min().allFinite() && box.max().allFinite() && (box.min().array() < box.max().array()).all(),
          "crop: expected a box with finite corners, the first below the second on every axis");
  const auto [first, last] = cells_of(box, map.resolution());
  const Eigen::AlignedBox3d snapped(first.cast<double>() * map.resolution(),
                                    (last.array() + 1).cast<double>().matrix() * map.resolution());
  const auto tree = empty_like(map.tree(), map.resolution());
  if (map.tree().getRoot() != nullptr) crop_below(*map.tree().getRoot(), CellCube{}, first, last, *tree);
  tree->finish();
  tree->add_hand_edits({.cut = occupied_voxels(map.tree()) - occupied_voxels(*tree)});
  std::vector<PaintedVolume> volumes;
  for (const PaintedVolume& volume : map.volumes()) volumes.push_back(cropped(volume, snapped));
  if (map.seen() == nullptr) return {tree, std::move(volumes)};
  return {tree, std::move(volumes), std::make_shared<const SeenStamps>(map.seen()->cropped(first, last))};
}

// ---- coarsening

namespace {

/// What is known of all voxels of one coarse voxel together.
struct CountedBlock {
  unsigned mask = 0xffff;  ///< volumes that paint all
  bool all_observed = true;
  float highest = std::numeric_limits<float>::lowest();  ///< log-odds of those observed

  void add(const FusedNode* leaf) {
    mask &= leaf == nullptr ? 0U : leaf->painted();
    if (leaf != nullptr && leaf->observed()) {
      highest = std::max(highest, leaf->getLogOdds());
    } else {
      all_observed = false;
    }
  }
};

void add_below(const FusedNode* node, CountedBlock& block) {
  if (node == nullptr || !node->has_children()) return block.add(node);
  for (unsigned i = 0; i < 8; ++i) add_below(node->child(i), block);
}

/// Writes the coarse voxels below a node; cubes of `finest` cells become one.
void coarsen_below(const FusedNode& node, const CellCube& cube, int finest, FusedTree& result) {
  const bool whole = cube.edge == CellCube{}.edge;  // no cube of the new tree; its octants are
  if (whole || (node.has_children() && cube.edge > finest)) {
    for (unsigned i = 0; i < 8; ++i) {
      const FusedNode* part = node.has_children() ? node.child(i) : &node;
      if (part != nullptr) coarsen_below(*part, cube.child(i), finest, result);
    }
    return;
  }
  CountedBlock block;
  add_below(&node, block);
  const bool occupied = block.highest >= result.getOccupancyThresLog();
  FusedNode coarse;
  if (occupied || block.all_observed) coarse.observe(block.highest);
  coarse.add_paint(static_cast<std::uint16_t>(block.mask));
  if (!coarse.observed() && coarse.painted() == 0) return;
  result.set_leaf({cube.corner / finest, cube.edge / finest}, coarse);
}

}  // namespace

Snapshot coarsen(const Snapshot& map, double resolution) {
  const double ratio = resolution / map.resolution();
  int factor = 2;
  while (factor < 32768 && factor < ratio * (1 - 1e-9)) factor *= 2;
  require(std::abs(ratio / factor - 1.0) <= 1e-9 && resolution <= 100.0,
          "coarsen: the map has voxels of " + short_text(map.resolution()) +
              " m, expected 2, 4, 8 ... times that (at most 100 m), got " + short_text(resolution));
  const auto tree = empty_like(map.tree(), map.resolution() * factor);
  if (map.tree().getRoot() != nullptr) coarsen_below(*map.tree().getRoot(), CellCube{}, factor, *tree);
  tree->finish();
  if (map.seen() == nullptr) return {tree, map.volumes()};
  auto seen = std::make_shared<const SeenStamps>(*map.seen());
  for (int edge = 1; edge < factor; edge *= 2) seen = std::make_shared<const SeenStamps>(seen->halved());
  return {tree, map.volumes(), std::move(seen)};
}

}  // namespace clearway
