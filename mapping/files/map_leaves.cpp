#include "mapping/files/map_leaves.hpp"

#include <algorithm>
#include <array>
#include <limits>
#include <numeric>
#include <stdexcept>
#include <utility>
#include <vector>

#include "mapping/system/number_text.hpp"
#include "mapping/voxels/fused_tree.hpp"
#include "mapping/voxels/leaf_pairs.hpp"

namespace clearway {

namespace {

bool blocks(VoxelState state) { return state == VoxelState::occupied || state == VoxelState::conflict; }

/// See MapLeaves::difference.
VoxelState difference_state(VoxelState here, VoxelState there) {
  if (blocks(here) && blocks(there)) return VoxelState::occupied;
  if (blocks(there)) return VoxelState::conflict;
  if (blocks(here)) return VoxelState::painted;
  return here == there ? VoxelState::unknown : VoxelState::seen_free;
}

/// Voxels first ... last - 1 of an axis.
struct Span {
  int first = std::numeric_limits<int>::max(), last = std::numeric_limits<int>::min();
  int length() const { return first < last ? last - first : 0; }
  Span joined(const Span& other) const { return {std::min(first, other.first), std::max(last, other.last)}; }
};

/// How much lies where along each axis, in slabs of 16 voxels.
class Slabs {
 public:
  void add(const Eigen::Vector3i& corner, int edge) {
    for (int axis = 0; axis < 3; ++axis)
      for (int from = corner[axis], to = from + edge; from < to;) {
        const int slab = slab_of(from), next = std::min(to, low_of(slab + 1));
        volumes_[static_cast<std::size_t>(axis)][static_cast<std::size_t>(slab)] +=
            static_cast<double>(edge) * edge * (next - from);
        from = next;
      }
  }
  bool is_empty() const { return volume(0) == 0.0; }
  /// Without the outermost ones at either end, which hold at most `share` of all.
  Span trimmed(int axis, double share) const {
    const auto& volumes = volumes_[static_cast<std::size_t>(axis)];
    const double least = share * volume(axis);
    int first = 0, last = count;
    for (double sum = volumes.front(); sum <= least; sum += volumes[static_cast<std::size_t>(first)]) ++first;
    for (double sum = volumes.back(); sum <= least; sum += volumes[static_cast<std::size_t>(last - 1)])
      --last;
    return {low_of(first), low_of(last)};
  }
  /// From the first to the last that holds at least `share` of what the fullest one holds: the rays to a few
  /// far returns leave little in each.
  Span dense(int axis, double share) const {
    const auto& volumes = volumes_[static_cast<std::size_t>(axis)];
    const double least = share * *std::max_element(volumes.begin(), volumes.end());
    const auto is_dense = [&](double volume) { return volume >= least; };
    const auto first = std::find_if(volumes.begin(), volumes.end(), is_dense) - volumes.begin();
    const auto behind = std::find_if(volumes.rbegin(), volumes.rend(), is_dense) - volumes.rbegin();
    return {low_of(static_cast<int>(first)), low_of(count - static_cast<int>(behind))};
  }
  /// With what lies outside at most `gap` voxels from it, or from what so came to it.
  Span with_near(int axis, const Span& span, int gap) const {
    const auto& volumes = volumes_[static_cast<std::size_t>(axis)];
    const int slabs = (gap + thickness - 1) / thickness;
    int first = slab_of(span.first), last = slab_of(span.last - 1) + 1;
    for (int next = first - 1; next >= 0 && next >= first - slabs; --next)
      if (volumes[static_cast<std::size_t>(next)] > 0.0) first = next;
    for (int next = last; next < count && next < last + slabs; ++next)
      if (volumes[static_cast<std::size_t>(next)] > 0.0) last = next + 1;
    return {std::min(span.first, low_of(first)), std::max(span.last, low_of(last))};
  }

 private:
  static constexpr int thickness = 16, count = 65536 / thickness;
  static int slab_of(int cell) { return (cell + 32768) / thickness; }
  static int low_of(int slab) { return slab * thickness - 32768; }
  double volume(int axis) const {
    const auto& volumes = volumes_[static_cast<std::size_t>(axis)];
    return std::accumulate(volumes.begin(), volumes.end(), 0.0);
  }
  std::array<std::vector<double>, 3> volumes_{std::vector<double>(count), std::vector<double>(count),
                                              std::vector<double>(count)};
};

/// What MapLeaves::main_bounds looks at.
struct Contents {
  Slabs occupied, free;
  Eigen::AlignedBox3i kept;  ///< painted or in conflict

  void add(const MapLeaf& leaf) {
    if (leaf.state == VoxelState::occupied) occupied.add(leaf.corner, leaf.edge);
    if (leaf.state == VoxelState::seen_free) free.add(leaf.corner, leaf.edge);
    if (leaf.state != VoxelState::painted && leaf.state != VoxelState::conflict) return;
    kept.extend(leaf.corner);
    kept.extend(Eigen::Vector3i(leaf.corner.array() + leaf.edge));
  }
};

using Spans = std::array<Span, 3>;

int longest(const Spans& spans) {
  return std::max({spans[0].length(), spans[1].length(), spans[2].length()});
}

/// See MapLeaves::main_bounds.
Eigen::AlignedBox3i main_part(Eigen::AlignedBox3i cells, const Contents& contents) {
  constexpr double far_share = 0.002, dense_share = 0.01;
  constexpr int far_times = 3, margin_share = 10;
  Spans spans;
  for (int axis = 0; axis < 3; ++axis) {
    Span& span = spans[static_cast<std::size_t>(axis)];
    if (!contents.kept.isEmpty()) span = {contents.kept.min()[axis], contents.kept.max()[axis]};
    if (!contents.occupied.is_empty()) span = span.joined(contents.occupied.trimmed(axis, far_share));
    if (!contents.free.is_empty()) span = span.joined(contents.free.dense(axis, dense_share));
  }
  if (longest(spans) == 0) return cells;
  const int gap = longest(spans);
  for (int axis = 0; axis < 3; ++axis) {
    Span& span = spans[static_cast<std::size_t>(axis)];
    span = contents.occupied.with_near(axis, span, gap);
  }
  const int length = longest(spans), margin = length / margin_share;
  for (int axis = 0; axis < 3; ++axis) {
    const Span& span = spans[static_cast<std::size_t>(axis)];
    if (cells.sizes()[axis] <= far_times * length) continue;
    cells.min()[axis] = std::max(cells.min()[axis], span.first - margin);
    cells.max()[axis] = std::min(cells.max()[axis], span.last + margin);
  }
  return cells;
}

}  // namespace

MapLeaves::MapLeaves(Snapshot map)
    : MapLeaves(map, [map](const Visit& visit) {
        map.tree().visit_leaves([&](const FusedNode& node, const CellCube& cube) {
          visit({map.tree().state(node), node.painted(), cube.corner, cube.edge, node.observed(),
                 node.getLogOdds()});
        });
      }) {
  tree_bytes_ = map.tree().memoryUsage();
}

MapLeaves::MapLeaves(Snapshot about, std::function<void(const Visit&)> walk)
    : about_(std::move(about)), walk_(std::move(walk)) {
  survey();
}

MapLeaves MapLeaves::difference(const Snapshot& here, const Snapshot& there) {
  if (here.resolution() != there.resolution())
    throw std::invalid_argument("the maps have voxels of " + to_text(here.resolution()) + " m and " +
                                to_text(there.resolution()) + " m, expected the same to show a difference");
  return {here, [here, there](const Visit& visit) {
            const auto state = [](const Snapshot& map, const FusedNode* node) {
              return node == nullptr ? VoxelState::unknown : map.tree().state(*node);
            };
            visit_leaf_pairs(
                here.tree(), there.tree(), [&](const FusedNode* a, const FusedNode* b, const CellCube& cube) {
                  visit({difference_state(state(here, a), state(there, b)), 0, cube.corner, cube.edge});
                });
          }};
}

void MapLeaves::survey() {
  walk_([this](const MapLeaf& leaf) {
    const auto edge = static_cast<std::size_t>(leaf.edge);
    const std::size_t voxels = edge * edge * edge;
    if (leaf.state == VoxelState::painted) counts_.painted += voxels;
    if (leaf.state == VoxelState::seen_free) counts_.seen_free += voxels;
    if (leaf.state == VoxelState::occupied) counts_.occupied += voxels;
    if (leaf.state == VoxelState::conflict) counts_.conflict += voxels;
    cells_.extend(leaf.corner);
    cells_.extend(Eigen::Vector3i(leaf.corner.array() + leaf.edge));
    painted_ |= leaf.volumes;
    ++leaves_;
  });
}

Eigen::AlignedBox3d MapLeaves::metres(const Eigen::AlignedBox3i& cells) const {
  if (cells.isEmpty()) return {};
  return {cells.min().cast<double>() * resolution(), cells.max().cast<double>() * resolution()};
}

Eigen::AlignedBox3d MapLeaves::bounds() const { return metres(cells_); }

Eigen::AlignedBox3d MapLeaves::main_bounds() const {
  if (!main_cells_) {
    Contents contents;
    walk_([&](const MapLeaf& leaf) { contents.add(leaf); });
    main_cells_ = main_part(cells_, contents);
  }
  return metres(*main_cells_);
}

void MapLeaves::visit(const Visit& visit) const {
  walk_([&](const MapLeaf& leaf) {
    if (leaf.state != VoxelState::unknown) visit(leaf);
  });
}

}  // namespace clearway
