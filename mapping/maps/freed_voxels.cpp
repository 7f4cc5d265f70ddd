#include "mapping/maps/freed_voxels.hpp"

#include "mapping/stamps/seen_stamps.hpp"
#include "mapping/voxels/fused_tree.hpp"

namespace clearway {

Snapshot with_free_voxels(const Snapshot& map, const std::vector<Eigen::Vector3d>& points, bool is_painted) {
  constexpr std::uint16_t every_volume = (1U << FusedTree::volume_limit) - 1U;
  const auto tree = std::make_shared<FusedTree>(map.tree());
  for (const Eigen::Vector3d& point : points)
    if (const auto cell = tree->cell(point)) tree->free_voxel(*cell, is_painted ? every_volume : 0);
  std::shared_ptr<const SeenStamps> seen;
  if (map.seen() != nullptr) seen = std::make_shared<const SeenStamps>(*map.seen());
  return {tree, map.volumes(), map, std::move(seen)};
}

}  // namespace clearway
