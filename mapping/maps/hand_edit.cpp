#include "mapping/maps/hand_edit.hpp"

#include "mapping/stamps/seen_stamps.hpp"
#include "mapping/system/number_text.hpp"
#include "mapping/voxels/fused_tree.hpp"

namespace clearway {
namespace {

/// Changes the voxels that are not yet as they should be, and counts them by paint.
Snapshot edited_voxels(const Snapshot& map, const std::vector<Eigen::Vector3d>& points, bool is_occupied,
                       std::size_t& unpainted, std::size_t& painted) {
  const auto tree = std::make_shared<FusedTree>(map.tree());
  std::uint64_t changed = 0;
  for (const Eigen::Vector3d& point : points) {
    const auto cell = tree->cell(point);
    if (!cell) continue;
    CellCube cube;
    const FusedNode* leaf = tree->find_leaf(*cell, cube);
    const bool is_observed = leaf != nullptr && leaf->observed();
    const bool was_occupied = is_observed && leaf->getLogOdds() >= tree->getOccupancyThresLog();
    if (is_observed && was_occupied == is_occupied) continue;
    ++(leaf != nullptr && leaf->painted() != 0 ? painted : unpainted);
    ++changed;
    is_occupied ? tree->occupy_voxel(*cell) : tree->free_voxel_by_hand(*cell);
  }
  tree->add_hand_edits(is_occupied ? HandEdits{changed, 0} : HandEdits{0, changed});
  std::shared_ptr<const SeenStamps> seen;
  if (map.seen() != nullptr) seen = std::make_shared<const SeenStamps>(*map.seen());
  return {tree, map.volumes(), map, std::move(seen)};
}

}  // namespace

Snapshot with_occupied_voxels(const Snapshot& map, const std::vector<Eigen::Vector3d>& points,
                              HandEditTally& tally) {
  return edited_voxels(map, points, true, tally.occupied, tally.conflict);
}

Snapshot with_cleared_voxels(const Snapshot& map, const std::vector<Eigen::Vector3d>& points,
                             HandEditTally& tally) {
  return edited_voxels(map, points, false, tally.seen_free, tally.painted);
}

std::string hand_edit_caveat(const Snapshot& map) {
  const HandEdits& edits = map.tree().hand_edits();
  std::string caveat;
  if (edits.occupied > 0 || edits.freed > 0)
    caveat = "the map was edited by hand: " + counted(edits.occupied, "voxel") + " made occupied, " +
             counted(edits.freed, "voxel") + " made free";
  if (edits.cut > 0)
    caveat += (caveat.empty() ? "" : "; ") + std::string("the map was cropped: ") +
              counted(edits.cut, "occupied voxel was", "occupied voxels were") + " cut off";
  return caveat;
}

}  // namespace clearway
