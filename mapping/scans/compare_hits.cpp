#include "mapping/scans/compare_hits.hpp"

#include <algorithm>
#include <bit>

namespace clearway {
namespace {

constexpr std::size_t most_compared = 1024;  // voxels of a scan: enough for 0.1 % after a few scans

enum class Known { nothing, free, occupied };

Known known(const FusedTree& tree, const Eigen::Vector3i& cell) {
  CellCube cube;
  if ((cell.array() < -32768).any() || (cell.array() > 32767).any()) return Known::nothing;
  const FusedNode* leaf = tree.find_leaf(cell, cube);
  if (leaf == nullptr || !leaf->observed()) return Known::nothing;
  return tree.isNodeOccupied(leaf) ? Known::occupied : Known::free;
}

bool is_beside_occupied(const FusedTree& tree, const Eigen::Vector3i& cell) {
  for (int axis = 0; axis < 3; ++axis)
    for (const int step : {-1, 1})
      if (known(tree, cell + step * Eigen::Vector3i::Unit(axis)) == Known::occupied) return true;
  return false;
}

}  // namespace

ScanAgreement compare_hits(const FusedTree& before, ScanGrid& grid) {
  ScanAgreement agreement;
  if (before.size() == 0) return agreement;
  const std::vector<ScanTile*> tiles = grid.tiles();
  std::size_t hits = 0;
  for (const ScanTile* tile : tiles)
    for (const std::uint64_t word : tile->occupied) hits += static_cast<std::size_t>(std::popcount(word));
  const std::size_t every = std::max<std::size_t>(1, hits / most_compared);
  std::size_t number = 0;
  for (const ScanTile* tile : tiles) {
    for (unsigned word = 0; word < ScanTile::words; ++word) {
      for (std::uint64_t bits = tile->occupied[word]; bits != 0; bits &= bits - 1) {
        if (number++ % every != 0) continue;
        const Eigen::Vector3i cell = tile->cell_of(64 * word + static_cast<unsigned>(std::countr_zero(bits)));
        const Known was = known(before, cell);
        const bool is_stable = was == Known::occupied || is_beside_occupied(before, cell);
        const unsigned is_free = was == Known::free ? 1 : 0;
        ++agreement.compared;
        agreement.looked_up += is_stable ? 1 : 0;
        (is_stable ? agreement.called_free : agreement.amid_free) += is_free;
      }
    }
  }
  return agreement;
}

}  // namespace clearway
