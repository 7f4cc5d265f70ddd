#pragma once

#include <Eigen/Core>
#include <array>
#include <cstdint>
#include <memory>
#include <unordered_map>
#include <vector>

namespace clearway {

/// Bits for a cube of 32 x 32 x 32 cells: which of them one scan calls free, which occupied, and which of the
/// free ones it saw clearly. Bits lie in octree order: word w holds a cube of 4 x 4 x 4 cells, byte b of a
/// word one of 2 x 2 x 2, and 8 (64) consecutive words one of 8 x 8 x 8 (16 x 16 x 16).
struct ScanTile {
  static constexpr int edge = 32;
  static constexpr int words = 512;

  Eigen::Vector3i corner = Eigen::Vector3i::Zero();  ///< smallest cell, a multiple of 32
  std::array<std::uint64_t, words> free{};
  std::array<std::uint64_t, words> occupied{};
  /// Which free cells the scan saw through clearly: nothing was hit near them. Only spare_surfaces fills it,
  /// for every tile; before, it holds anything.
  std::array<std::uint64_t, words> clear{};
  /// Cells near a hit, hits included, in which nothing is freed. Only spare_surfaces fills it, when asked to.
  std::array<std::uint64_t, words> spared{};

  /// Position of a cell's bit in octree order, 0..32767: word `bit >> 6`, bit `bit & 63` of it. Only the
  /// cell's position within its tile counts.
  static unsigned bit_of(const Eigen::Vector3i& cell) {
    return spread[cell.x() & 31] | spread[cell.y() & 31] << 1U | spread[cell.z() & 31] << 2U;
  }
  /// The cell of a bit.
  Eigen::Vector3i cell_of(unsigned bit) const { return corner + local_of(bit); }
  /// The same within the tile, 0 to 31 on each axis.
  static Eigen::Vector3i local_of(unsigned bit) {
    return {gathered(bit), gathered(bit >> 1U), gathered(bit >> 2U)};
  }

 private:
  static constexpr std::array<unsigned, 32> spread = [] {
    std::array<unsigned, 32> table{};
    for (unsigned v = 0; v < 32; ++v)
      for (unsigned i = 0; i < 5; ++i) table[v] |= (v >> i & 1U) << 3 * i;
    return table;
  }();

  /// Bits 0, 3, 6, 9 and 12 side by side.
  static int gathered(unsigned bits) {
    bits &= 0x1249U;
    bits = (bits | bits >> 2U) & 0x10c3U;
    bits = (bits | bits >> 4U) & 0x100fU;
    return static_cast<int>((bits | bits >> 8U) & 0x1fU);
  }
};

/// What one scan says of the cells it touches, before the tree is updated: tiles of bits, made where needed,
/// so that a few far points cost no more than the tiles that their rays cross. A cell may be both free and
/// occupied; the tree then takes it as occupied (FusedTree::update). Between ray casting and the update the
/// bits may be changed at will, for example to take cells beside a surface out of `free`.
///
/// Cells are those of FusedTree: floor(coordinate / resolution), from -32768 to 32767 on each axis.
class ScanGrid {
 public:
  /// The tile that holds a cell, made empty when there is none.
  /// @throws std::runtime_error when the machine has no memory left for more (memory_room.hpp).
  ScanTile& tile(const Eigen::Vector3i& cell);
  /// The same, null when there is none.
  ScanTile* find(const Eigen::Vector3i& cell);
  const ScanTile* find(const Eigen::Vector3i& cell) const;

  bool is_free(const Eigen::Vector3i& cell) const;
  bool is_occupied(const Eigen::Vector3i& cell) const;
  void set_free(const Eigen::Vector3i& cell) { set(tile(cell).free, cell); }
  /// True when the cell was not occupied before.
  bool set_occupied(const Eigen::Vector3i& cell) { return set(tile(cell).occupied, cell); }
  void clear_free(const Eigen::Vector3i& cell);

  /// All tiles in octree order.
  std::vector<ScanTile*> tiles();

  /// What FusedTree::update needs for these cells in an empty tree, bytes. One that has to part larger leaves
  /// for them may need more.
  std::uint64_t tree_bytes() const;
  /// The same for the cells of a tile, another one for each.
  static std::uint64_t key_of(const Eigen::Vector3i& cell);
  std::size_t tile_count() const { return index_.size(); }

  /// Makes all cells untouched; keeps the memory of at most 4096 tiles (64 MB) for the next scan.
  void clear();

 private:
  static bool set(std::array<std::uint64_t, ScanTile::words>& bits, const Eigen::Vector3i& cell) {
    const unsigned bit = ScanTile::bit_of(cell);
    const std::uint64_t mask = std::uint64_t{1} << (bit & 63U), before = bits[bit >> 6U];
    bits[bit >> 6U] = before | mask;
    return (before & mask) == 0;
  }

  std::unordered_map<std::uint64_t, ScanTile*> index_;
  std::vector<std::unique_ptr<ScanTile>> store_;  ///< the first index_.size() are in use
  std::uint64_t last_key_ = ~std::uint64_t{0};
  ScanTile* last_ = nullptr;
};

}  // namespace clearway
