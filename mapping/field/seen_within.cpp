#include "mapping/field/seen_within.hpp"

#include <cmath>
#include <locale>
#include <sstream>
#include <stdexcept>

#include "mapping/field/blocked_cells.hpp"
#include "mapping/stamps/seen_stamps.hpp"
#include "mapping/voxels/fused_tree.hpp"

namespace clearway {

void require_seen_within(double seen_within, const SeenStamps* seen) {
  if (!std::isfinite(seen_within) || seen_within < 0.0)
    throw std::invalid_argument("seen within: expected a finite time not below 0, in seconds");
  if (seen_within == 0.0) return;
  std::ostringstream text;
  text.imbue(std::locale::classic());
  text << "seen within " << seen_within << " s: ";
  if (seen == nullptr) {
    text << "the map does not know when its voxels were seen, expected one fused from scans with times";
    throw std::invalid_argument(text.str());
  }
  if (seen_within >= seen->period()) return;
  text << "the map knows times to " << seen->period() << " s, expected no less than that";
  throw std::invalid_argument(text.str());
}

void require_seen_within(const Requirement& requirement, const SeenStamps* seen) {
  if (requirement.seen_within > 0.0 && requirement.policy != Policy::known_free)
    throw std::invalid_argument(
        "seen within: only the policy known_free asks when a voxel was seen, expected "
        "it or no age, got the policy " +
        std::string(to_string(requirement.policy)));
  require_seen_within(requirement.seen_within, seen);
}

BlockedCells blocked_cells(const FusedTree& tree, const SeenStamps* seen, const Requirement& requirement,
                           const Eigen::Vector3i& first, const Eigen::Vector3i& size, int threads) {
  require_seen_within(requirement, seen);
  BlockedCells cells = blocked_cells(tree, requirement, first, size, threads);
  if (requirement.seen_within == 0.0) return cells;
  const BlockedCells not_painted = blocked_cells(tree, {Policy::painted, 0xffff}, first, size, threads);
  BlockedCells not_seen(size, true);
  const Eigen::Vector3i last = first + size - Eigen::Vector3i::Ones();
  seen->visit_since(seen->newest() - requirement.seen_within, first, last, [&](const CellCube& cube) {
    const Eigen::Vector3i low = cube.corner - first;
    if (cube.edge == 1) return not_seen.set(low.x(), low.y(), low.z(), false);
    not_seen.fill(low, low.array() + cube.edge, false);
  });
  cells.block_where_both(not_painted, not_seen);
  return cells;
}

}  // namespace clearway
