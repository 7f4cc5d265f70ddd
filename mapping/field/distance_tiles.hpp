#pragma once

#include <Eigen/Core>
#include <array>
#include <atomic>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <memory>
#include <mutex>
#include <utility>
#include <vector>

#include "mapping/field/blocked_cells.hpp"
#include "mapping/field/distance_axes.hpp"

namespace clearway {

/// The squared distances of a block of cells to its blocked cubes (see DistanceAxes) in tiles of 32 x 8 x 8
/// cells, x fastest. A tile is computed when it is first looked at, from any thread, and so are the blocked
/// cells that it needs; what is known stays as it is. Two versions share what they have in common. To whoever
/// reads, an object never changes: each cell's number depends on the blocked cells alone.
class DistanceTiles {
 public:
  static constexpr int nx = lane_cells, ny = 8, nz = 8;
  static constexpr std::size_t tile_cells = std::size_t{nx} * ny * nz;

  using Box = CellBox;
  /// Writes all cells of a box, and of no other, into the block.
  using ReadCells = std::function<void(const Box&, BlockedCells&)>;

  /// Visits boxes of cells that hold all blocked ones, quickly: the boxes may be larger, a tile or more.
  using VisitBlocked = std::function<void(const std::function<void(const Box&)>&)>;

  /// @param cap min(cap, squared distance) is kept, 1 to largest_cap
  DistanceTiles(BlockedCells blocked, std::uint16_t cap);
  /// The same with cells that are read where they are needed. @param read called by one thread at a time
  /// @param visit of the same cells; without it, each tile that may matter is read
  DistanceTiles(const Eigen::Vector3i& size, std::uint16_t cap, ReadCells read, VisitBlocked visit = {});

  /// Brings cells up to date, and names boxes that hold all that changed; cells that were not read may become
  /// anything.
  using FollowCells = std::function<std::vector<Box>(BlockedCells&)>;
  /// Of a later version of the same block: tiles that `before` knows and no change reaches are shared.
  /// @param read reads cells of the later version @param visit of the later version
  DistanceTiles(const DistanceTiles& before, const FollowCells& follow, ReadCells read,
                VisitBlocked visit = {});
  /// The same from cells that are all known, as they are in `before`.
  DistanceTiles(const DistanceTiles& before, BlockedCells blocked);
  ~DistanceTiles();

  const Eigen::Vector3i& size() const { return blocked_.size(); }
  std::uint16_t cap() const { return axes_.cap(); }

  /// min(cap, squared distance in half voxels); 0 in blocked cells only.
  std::uint16_t squared(int x, int y, int z) const { return line(x >> 5, y, z)[x & 31]; }
  /// The squared distances of the 32 cells from x = 32 lane; those beyond the block mean nothing.
  const std::uint16_t* line(int lane, int y, int z) const {
    const std::size_t index = tile(lane, y, z);
    const std::uint16_t* cells = known_[index].load(std::memory_order_acquire);
    return (cells != nullptr ? cells : computed(index)) + ((z & 7) * ny + (y & 7)) * nx;
  }

  bool is_blocked(int x, int y, int z) const {
    const std::size_t index = tile(x >> 5, y, z);
    if (!is_read_[index].load(std::memory_order_acquire)) read_cells(index);
    return blocked_.at(x, y, z);
  }
  /// Blocked cells of which those near a cell are known whose distance was looked at: within its tile, and
  /// wherever the distance reaches.
  const BlockedCells& blocked_nearby() const { return blocked_; }
  /// Blocked cells of which those from low to high (inclusive) are known.
  const BlockedCells& blocked_in(const Eigen::Vector3i& low, const Eigen::Vector3i& high) const;
  /// All of them.
  const BlockedCells& blocked() const;

  /// For look-ups of many cells: the first cell of each tile, null where it is not known yet; and the tiles
  /// along each axis, those along x first, then y, then z.
  const std::atomic<const std::uint16_t*>* known_tiles() const { return known_.get(); }
  const Eigen::Vector3i& tile_counts() const { return counts_; }
  std::size_t tile(int lane, int y, int z) const {
    return (static_cast<std::size_t>(z >> 3) * static_cast<std::size_t>(counts_[1]) +
            static_cast<std::size_t>(y >> 3)) *
               static_cast<std::size_t>(counts_[0]) +
           static_cast<std::size_t>(lane);
  }

  Eigen::Vector3i place(std::size_t tile) const;  ///< along each axis
  Box box_of(const Eigen::Vector3i& place) const;

  /// Computes the tiles that an earlier version knew and changes reached: they were of use.
  void renew() const;
  void complete() const;      ///< computes all that is left
  std::size_t known() const;  ///< tiles
  std::size_t bytes() const;  ///< in memory, tiles shared with other versions included

 private:
  using Tile = std::array<std::uint16_t, tile_cells>;
  /// Where there may be blocked cells: in a tile, or in those that matter to it along z, along z and y, along
  /// all axes.
  static constexpr std::uint8_t here = 1, along_z = 2, in_plane = 4, within_reach = 8;
  class Maker;
  struct Memory;

  void allocate();
  void share(const DistanceTiles& before, const std::vector<Box>& changes);
  bool any_at_least(std::size_t tile, int distance) const;
  std::vector<bool> reached_by_changes(const std::vector<Box>& changes) const;
  std::vector<std::pair<std::size_t, Box>> changes_in_tiles(const std::vector<Box>& changes) const;
  const std::uint16_t* computed(std::size_t tile) const;
  void read_cells(std::size_t tile) const;
  void read_under_lock(std::size_t tile) const;
  void look_near() const;
  bool any_blocked(const Box& box) const;
  void spread(int axis, std::uint8_t from, std::uint8_t to) const;

  DistanceAxes axes_;
  mutable BlockedCells blocked_;
  ReadCells read_;
  VisitBlocked visit_blocked_;
  std::shared_ptr<const Tile> nothing_, all_;  ///< tiles without a blocked cell in reach, and without another
  Eigen::Vector3i counts_, reach_;             ///< tiles along each axis; so many to each side matter to one
  std::unique_ptr<std::atomic<const std::uint16_t*>[]> known_;
  std::unique_ptr<std::atomic<bool>[]> is_read_;  ///< of each tile: its blocked cells
  mutable std::atomic<bool> all_read_ = false;    ///< the blocked cells of every tile
  mutable std::mutex computing_;                  ///< of what follows, and of writing blocked_
  mutable std::vector<std::shared_ptr<const Tile>> tiles_;
  mutable std::unique_ptr<Memory> memory_;
  mutable std::vector<std::uint8_t> near_;  ///< of each tile; empty until the first is computed
  std::vector<std::size_t> outdated_;       ///< tiles that an earlier version knew
};

}  // namespace clearway
