#include "mapping/voxels/scan_grid.hpp"

#include <algorithm>
#include <bit>

#include "mapping/voxels/memory_room.hpp"
#include "mapping/voxels/node_pool.hpp"

namespace clearway {
namespace {

/// Spreads the 11 bits of a tile's coordinate to every third bit.
std::uint64_t spread_coordinate(int cell) {
  const auto tile = static_cast<std::uint64_t>(cell + 32768) / ScanTile::edge;
  std::uint64_t result = 0;
  for (unsigned i = 0; i < 11; ++i) result |= (tile >> i & 1U) << 3 * i;
  return result;
}

std::uint64_t octree_order(const ScanTile& tile) {
  return spread_coordinate(tile.corner.x()) | spread_coordinate(tile.corner.y()) << 1U |
         spread_coordinate(tile.corner.z()) << 2U;
}

}  // namespace

std::uint64_t ScanGrid::key_of(const Eigen::Vector3i& cell) {
  const auto coordinate = [&](int axis) { return static_cast<std::uint64_t>(cell[axis] + 32768) >> 5U; };
  return coordinate(0) | coordinate(1) << 11U | coordinate(2) << 22U;
}

ScanTile& ScanGrid::tile(const Eigen::Vector3i& cell) {
  const std::uint64_t key = key_of(cell);
  if (key == last_key_) return *last_;
  const auto [entry, is_new] = index_.try_emplace(key, nullptr);
  if (is_new) {
    const std::size_t used = index_.size() - 1;
    if (used == store_.size()) {
      store_.push_back(std::make_unique<ScanTile>());
    } else {
      store_[used]->free.fill(0);
      store_[used]->occupied.fill(0);
    }
    entry->second = store_[used].get();
    constexpr std::size_t portion = 256;
    if (index_.size() == store_.size() && store_.size() % portion == 0)  // the tree takes as much again
      require_memory((store_.size() + 2 * portion) * sizeof(ScanTile), "the voxels of a scan");
    for (int axis = 0; axis < 3; ++axis) entry->second->corner[axis] = cell[axis] & ~(ScanTile::edge - 1);
  }
  last_key_ = key;
  last_ = entry->second;
  return *last_;
}

ScanTile* ScanGrid::find(const Eigen::Vector3i& cell) {
  const auto entry = index_.find(key_of(cell));
  return entry == index_.end() ? nullptr : entry->second;
}

const ScanTile* ScanGrid::find(const Eigen::Vector3i& cell) const {
  const auto entry = index_.find(key_of(cell));
  return entry == index_.end() ? nullptr : entry->second;
}

bool ScanGrid::is_free(const Eigen::Vector3i& cell) const {
  const ScanTile* tile = find(cell);
  const unsigned bit = ScanTile::bit_of(cell);
  return tile != nullptr && (tile->free[bit >> 6U] >> (bit & 63U) & 1U) != 0;
}

bool ScanGrid::is_occupied(const Eigen::Vector3i& cell) const {
  const ScanTile* tile = find(cell);
  const unsigned bit = ScanTile::bit_of(cell);
  return tile != nullptr && (tile->occupied[bit >> 6U] >> (bit & 63U) & 1U) != 0;
}

void ScanGrid::clear_free(const Eigen::Vector3i& cell) {
  ScanTile* tile = find(cell);
  const unsigned bit = ScanTile::bit_of(cell);
  if (tile != nullptr) tile->free[bit >> 6U] &= ~(std::uint64_t{1} << (bit & 63U));
}

std::vector<ScanTile*> ScanGrid::tiles() {
  std::vector<std::pair<std::uint64_t, ScanTile*>> ordered;
  ordered.reserve(index_.size());
  for (const auto& entry : index_) ordered.emplace_back(octree_order(*entry.second), entry.second);
  std::sort(ordered.begin(), ordered.end());
  std::vector<ScanTile*> result;
  result.reserve(ordered.size());
  for (const auto& entry : ordered) result.push_back(entry.second);
  return result;
}

std::uint64_t ScanGrid::tree_bytes() const {
  constexpr std::uint64_t leaf = NodePool::node_bytes, inner = leaf + NodePool::children_bytes;
  std::uint64_t bytes = 0;
  for (std::size_t i = 0; i < index_.size(); ++i) {
    const ScanTile& tile = *store_[i];
    bytes += (1 + 8 + 64) * inner;  // cubes of 32, 16 and 8 cells
    for (unsigned word = 0; word < ScanTile::words; ++word) {
      const std::uint64_t hit = tile.occupied[word], any = tile.free[word] | hit;
      if (any == 0) continue;
      const bool is_one_leaf = any == ~std::uint64_t{0} && hit == 0;
      bytes += is_one_leaf ? leaf : inner;
      for (unsigned first = 0; first < 64 && !is_one_leaf; first += 8) {
        const std::uint64_t of_cube = any >> first & 0xffU;
        const bool is_whole = of_cube == 0xffU && (hit >> first & 0xffU) == 0;
        if (of_cube != 0)
          bytes += is_whole ? leaf : inner + leaf * static_cast<unsigned>(std::popcount(of_cube));
      }
    }
  }
  return bytes;
}

void ScanGrid::clear() {
  constexpr std::size_t kept = 4096;
  index_.clear();
  if (store_.size() > kept) store_.resize(kept);
  last_key_ = ~std::uint64_t{0};
  last_ = nullptr;
}

}  // namespace clearway
