#include "mapping/scans/contested_cells.hpp"

#include <algorithm>
#include <atomic>
#include <bit>

#include "mapping/system/parallel.hpp"
#include "mapping/voxels/tile_node.hpp"

namespace clearway {

void ContestedCells::weigh_tile(const FusedTree& tree, ScanTile& tile, Planes& planes,
                                std::vector<Eigen::Vector3i>& taken_back) {
  const FusedNode* const node = tile_node(tree, tile.corner);
  const float one_miss = 1.5F * tree.getProbMissLog();  // between one miss and two
  for (unsigned word = 0; word < ScanTile::words; ++word) {
    std::uint64_t &once = planes.once[word], &twice = planes.twice[word];
    const std::uint64_t hit = tile.occupied[word], spared = tile.spared[word] & ~hit;
    once &= ~hit;
    twice &= ~hit;
    const std::uint64_t contested = once | twice, unbelieved = tile.free[word] & ~hit & contested;
    tile.free[word] &= ~unbelieved;
    const std::uint64_t again = spared & once;
    once = ((once & ~unbelieved) | (twice & unbelieved)) & ~again;
    twice = (twice & ~unbelieved) | again;
    for (std::uint64_t bits = spared & ~contested; bits != 0; bits &= bits - 1) {
      const std::uint64_t bit = bits & (~bits + 1);
      const unsigned cell = 64 * word + static_cast<unsigned>(std::countr_zero(bits));
      const FusedNode* const leaf = leaf_below(node, cell);
      if (leaf == nullptr || !leaf->observed()) {
        once |= bit;
      } else if (!tree.isNodeOccupied(leaf) && leaf->getLogOdds() > one_miss) {
        taken_back.push_back(tile.cell_of(cell));
      }
    }
  }
}

void ContestedCells::weigh(FusedTree& tree, ScanGrid& grid, int threads) {
  const std::vector<ScanTile*> tiles = grid.tiles();
  std::vector<Planes*> planes(tiles.size(), nullptr);
  for (std::size_t i = 0; i < tiles.size(); ++i) {
    const auto found = planes_.find(ScanGrid::key_of(tiles[i]->corner));
    const auto& spared = tiles[i]->spared;
    if (found != planes_.end()) {
      planes[i] = found->second.get();
    } else if (std::any_of(spared.begin(), spared.end(), [](std::uint64_t word) { return word != 0; })) {
      planes[i] = (planes_[ScanGrid::key_of(tiles[i]->corner)] = std::make_unique<Planes>()).get();
    }
  }
  std::vector<std::vector<Eigen::Vector3i>> taken_back(tiles.size());
  std::atomic<std::size_t> next{0};
  parallel(static_cast<std::size_t>(threads), [&](std::size_t) {
    for (std::size_t i = next++; i < tiles.size(); i = next++)
      if (planes[i] != nullptr) weigh_tile(tree, *tiles[i], *planes[i], taken_back[i]);
  });
  for (const auto& cells : taken_back)
    for (const Eigen::Vector3i& cell : cells) tree.take_back(cell);
}

int ContestedCells::contested(const Eigen::Vector3i& cell) const {
  const auto found = planes_.find(ScanGrid::key_of(cell));
  if (found == planes_.end()) return 0;
  const unsigned bit = ScanTile::bit_of(cell);
  const auto is_set = [&](const auto& plane) {
    return static_cast<int>(plane[bit >> 6U] >> (bit & 63U) & 1U);
  };
  return is_set(found->second->once) + 2 * is_set(found->second->twice);
}

}  // namespace clearway
