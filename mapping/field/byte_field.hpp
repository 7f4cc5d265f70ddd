#pragma once

#include <Eigen/Core>
#include <atomic>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <mutex>
#include <span>

namespace clearway {

class BlockedField;
class DistanceTiles;

/// A BlockedField again with one byte a cell in one piece of memory, tile after tile of DistanceTiles, for
/// look-ups of many points side by side: half the memory, no pointers, and a third of a voxel less exact.
/// Tiles are made when they are looked at: who reads a 0 calls know() and reads again. Safe to use from many
/// threads; to whoever does so, it never changes.
struct ByteField {
  explicit ByteField(const BlockedField& field);
  ~ByteField();
  ByteField(const ByteField&) = delete;
  ByteField& operator=(const ByteField&) = delete;

  /// Makes a cell's tile.
  void know(std::size_t cell) const;

  /// Where a cell is in `cells`; field_memory_limit keeps it below 2^31.
  std::size_t index(int x, int y, int z) const {
    const int tile = (x >> 5) + tiles.x() * ((y >> 3) + tiles.y() * (z >> 3));
    return static_cast<std::size_t>(tile) << 11U |
           static_cast<std::size_t>((x & 31) | (y & 7) << 5 | (z & 7) << 8);
  }

  Eigen::Vector3i size;   ///< cells along each axis
  Eigen::Vector3i tiles;  ///< tiles along each axis, each of 32 x 8 x 8 cells
  Eigen::Vector3d low;    ///< corner of the first cell, map frame, metres
  double resolution;      ///< edge of a cell, metres
  double step;            ///< metres for each unit of a cell's number
  bool outside_blocked;   ///< what lies beyond the cells counts as blocked
  /// The number of a cell: step * (number - 1) <= the distance from its middle to the nearest blocked cube,
  /// metres, which is less than step * number where the number is below `end`. 1 in blocked cells, 0 in those
  /// that are not known yet. There are a few more, so that four bytes may be read at each.
  std::span<const std::uint8_t> cells;
  std::uint8_t end;

 private:
  void make(std::size_t tile) const;

  std::shared_ptr<const DistanceTiles> distances_;
  int units_;                                      ///< of a voxel's edge
  std::unique_ptr<std::atomic<bool>[]> is_known_;  ///< of each tile
  std::span<std::uint8_t> memory_;                 ///< of `cells`; each is written once, at most
  mutable std::mutex making_;
};

}  // namespace clearway
