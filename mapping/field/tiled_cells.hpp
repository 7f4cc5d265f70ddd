#pragma once

#include <Eigen/Core>
#include <array>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <vector>

namespace clearway {

/// 16-bit numbers of a block of cells in tiles of 32 x 8 x 8 (4 KiB each), x fastest. Copies share their
/// tiles; one is copied when it is first written. Tiles that hold one number alone are shared from the start.
/// Reading is safe from many threads; a copy may be written while others read the original.
class TiledCells {
 public:
  static constexpr int nx = 32, ny = 8, nz = 8;
  static constexpr std::size_t tile_bytes = 4096;

  /// All cells start at `value`.
  TiledCells(const Eigen::Vector3i& size, std::uint16_t value);
  TiledCells(const TiledCells& other)
      : size_(other.size_), tiles_(other.tiles_), cells_(other.cells_), shared_(tiles_.size(), 1) {}
  TiledCells(TiledCells&&) = default;
  TiledCells& operator=(const TiledCells&) = delete;
  TiledCells& operator=(TiledCells&&) = default;

  int lanes() const { return size_[0]; }  ///< tiles that span x

  std::uint16_t at(int x, int y, int z) const { return line(x >> 5, y, z)[x & 31]; }

  /// The 32 cells from x = 32 lane at y, z.
  const std::uint16_t* line(int lane, int y, int z) const { return cells_[tile(lane, y, z)] + offset(y, z); }

  /// The first cell of each tile, and the tiles along each axis; tiles along x come first, then y, then z.
  const std::uint16_t* const* tile_cells() const { return cells_.data(); }
  const Eigen::Vector3i& tile_counts() const { return size_; }

  /// Overwrites the 32 cells of a line, if they differ. Returns true when they did.
  bool write(int lane, int y, int z, const std::uint16_t* line);

  std::size_t tiles() const { return tiles_.size(); }
  std::size_t distinct_tiles() const;  ///< tiles kept in memory

 private:
  using Tile = std::array<std::uint16_t, static_cast<std::size_t>(nx* ny* nz)>;

  std::size_t tile(int lane, int y, int z) const {
    return static_cast<std::size_t>(((z >> 3) * size_[1] + (y >> 3)) * size_[0] + lane);
  }
  static int offset(int y, int z) { return ((z & 7) * ny + (y & 7)) * nx; }

  Eigen::Vector3i size_;  ///< in tiles
  std::vector<std::shared_ptr<Tile>> tiles_;
  std::vector<std::uint16_t*> cells_;  ///< of each tile, for those who read
  std::vector<std::uint8_t>
      shared_;  ///< by tile: another may hold it, so it must be copied before it is written
};

}  // namespace clearway
