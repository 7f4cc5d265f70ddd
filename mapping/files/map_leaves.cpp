#include "mapping/files/map_leaves.hpp"

#include <stdexcept>
#include <utility>

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

Eigen::AlignedBox3d MapLeaves::bounds() const {
  if (cells_.isEmpty()) return {};
  return {cells_.min().cast<double>() * resolution(), cells_.max().cast<double>() * resolution()};
}

void MapLeaves::visit(const Visit& visit) const {
  walk_([&](const MapLeaf& leaf) {
    if (leaf.state != VoxelState::unknown) visit(leaf);
  });
}

}  // namespace clearway
