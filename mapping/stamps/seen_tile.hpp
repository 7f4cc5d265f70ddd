#pragma once

#include <Eigen/Core>
#include <array>
#include <cstdint>
#include <memory>

namespace clearway {

struct ScanTile;

/// Stamps for a cube of 32 x 32 x 32 cells: when each was last seen, as the number of a period (SeenStamps
/// says of which), 0 for never. Blocks of 8 x 8 x 8 cells lie in octree order, and so do the cells in a block
/// (ScanTile::bit_of). A block whose cells all have the same stamp keeps that one alone.
class SeenTile {
 public:
  static constexpr int edge = 32;
  static constexpr std::size_t blocks = 64, block_cells = 512;
  using Block = std::array<std::uint16_t, block_cells>;

  explicit SeenTile(const Eigen::Vector3i& smallest_cell) : corner_(smallest_cell) {}
  SeenTile(const SeenTile& other);
  SeenTile& operator=(const SeenTile&) = delete;

  const Eigen::Vector3i& corner() const { return corner_; }

  std::uint16_t at(unsigned bit) const {
    const Block* block = mixed_[bit >> 9U].get();
    return block != nullptr ? (*block)[bit & 511U] : uniform_[bit >> 9U];
  }
  /// The stamps of a block's cells; null when all have the stamp `uniform(block)`.
  const Block* mixed(std::size_t block) const { return mixed_[block].get(); }
  std::uint16_t uniform(std::size_t block) const { return uniform_[block]; }

  void set_uniform(std::size_t block, std::uint16_t stamp);
  /// The block's stamps one by one, for writing.
  Block& spread(std::size_t block);

  /// Raises the stamps of the cells that a scan calls free or occupied to `stamp`; none is lowered.
  void raise(const ScanTile& scan, std::uint16_t stamp);
  /// Raises each cell's stamp to that of another tile.
  void raise(const SeenTile& other);
  /// Replaces each stamp but 0 by `change(stamp)`.
  template <class Change>
  void replace(const Change& change) {
    for (std::size_t block = 0; block < blocks; ++block) {
      if (uniform_[block] != 0) uniform_[block] = change(uniform_[block]);
      if (!mixed_[block]) continue;
      for (std::uint16_t& stamp : *mixed_[block]) {
        if (stamp != 0) stamp = change(stamp);
      }
    }
  }

  std::size_t bytes() const;

  std::uint64_t owner = 0;  ///< the one SeenStamps that may write here

 private:
  Eigen::Vector3i corner_;
  std::array<std::uint16_t, blocks> uniform_{};
  std::array<std::unique_ptr<Block>, blocks> mixed_;
};

}  // namespace clearway
