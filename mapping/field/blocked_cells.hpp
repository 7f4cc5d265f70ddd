#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <vector>

#include "mapping/voxels/voxel_state.hpp"

namespace clearway {

class FusedTree;
class SeenStamps;

/// Cells low to high (exclusive) of a block.
struct CellBox {
  Eigen::Vector3i low, high;
};

/// One bit a cell of a block: does a requirement forbid the voxel? Kept as words of 32 neighbours along x,
/// for each 32 columns of x all of z and y, y fastest: the order in which the distance transform reads them.
class BlockedCells {
 public:
  /// All cells start as `blocked`.
  BlockedCells(const Eigen::Vector3i& size, bool blocked);

  const Eigen::Vector3i& size() const { return size_; }
  int lanes() const { return lanes_; }  ///< words that span x

  bool at(int x, int y, int z) const { return (row(x >> 5, z)[y] >> (x & 31) & 1U) != 0; }

  /// Bits x - 1, x and x + 1 of a row, lowest first; cells outside the block read as free.
  unsigned around(int x, int y, int z) const;

  /// The words of the cells (32 lane to 32 lane + 31, all y, z), size().y() of them.
  const std::uint32_t* row(int lane, int z) const { return &words_[index(lane, z)]; }

  /// Sets the cells low to high (exclusive), which must lie in the block.
  void fill(const Eigen::Vector3i& low, const Eigen::Vector3i& high, bool blocked);

  /// The same for one cell.
  void set(int x, int y, int z, bool blocked) {
    std::uint32_t& word = words_[index(x >> 5, z) + static_cast<std::size_t>(y)];
    const std::uint32_t bit = 1U << (x & 31);
    word = blocked ? word | bit : word & ~bit;
  }

  /// Blocks also what both of two versions of the same block have blocked.
  void block_where_both(const BlockedCells& a, const BlockedCells& b);

  std::size_t count() const;  ///< of blocked cells
  /// Blocked cells here more than in another version of the same block; quick where little differs.
  std::ptrdiff_t count_beyond(const BlockedCells& other) const;
  std::size_t bytes() const { return words_.size() * sizeof(std::uint32_t); }

  /// Boxes outside of which this version of a block is the same as another one.
  std::vector<CellBox> differing(const BlockedCells& other) const;

  friend bool operator==(const BlockedCells&, const BlockedCells&) = default;

 private:
  std::size_t index(int lane, int z) const {
    return (static_cast<std::size_t>(lane) * static_cast<std::size_t>(size_.z()) +
            static_cast<std::size_t>(z)) *
           static_cast<std::size_t>(size_.y());
  }

  Eigen::Vector3i size_;
  int lanes_;
  std::vector<std::uint32_t> words_;  ///< bits beyond size().x() are 0
};

/// The cells first to first + size - 1 of `tree` that `requirement` forbids (cells as in CellCube), whenever
/// they were seen. The number of threads makes no difference to them.
BlockedCells blocked_cells(const FusedTree& tree, const Requirement& requirement,
                           const Eigen::Vector3i& first, const Eigen::Vector3i& size, int threads = 1);

/// Writes the cells low to high (exclusive, counted from `first`) of such a block, and no others.
void read_blocked_cells(const FusedTree& tree, const Requirement& requirement, const Eigen::Vector3i& first,
                        const Eigen::Vector3i& low, const Eigen::Vector3i& high, BlockedCells& cells);

/// Visits boxes of cells (counted from `first`) that hold all that are forbidden. A box holds free ones, too,
/// only where it is a cube of the tree, or a part of one, of at most `narrow` cells along an edge, 1 or more.
void visit_blocked_boxes(const FusedTree& tree, const Requirement& requirement, const Eigen::Vector3i& first,
                         const Eigen::Vector3i& size, int narrow,
                         const std::function<void(const CellBox&)>& visit);

/// Brings the cells of an earlier version of the tree, with the same occupancy threshold, up to date. Reads
/// only what the two versions do not share.
/// @returns boxes outside of which the cells stay as they are: cubes of which each cell changed, if `cells`
///          were those of `before`
std::vector<CellBox> follow_blocked_cells(const FusedTree& tree, const Requirement& requirement,
                                          const Eigen::Vector3i& first, const FusedTree& before,
                                          BlockedCells& cells, int threads = 1);

/// The same for the size of `cells_before`, which are those of an earlier version of the tree, with the same
/// occupancy threshold. Reads only what the two versions do not share.
BlockedCells blocked_cells(const FusedTree& tree, const Requirement& requirement,
                           const Eigen::Vector3i& first, const FusedTree& before,
                           const BlockedCells& cells_before, int threads = 1);

/// The same, and with requirement.seen_within the cells, too, that are free under `known_free` only because
/// they were seen, and not since seen->newest() - seen_within. These cannot be derived from what changed in
/// the tree: voxels age while it stays as it is.
/// @throws std::invalid_argument for a seen_within that is no time, or in a map that knows no times, or knows
///         them less exactly.
BlockedCells blocked_cells(const FusedTree& tree, const SeenStamps* seen, const Requirement& requirement,
                           const Eigen::Vector3i& first, const Eigen::Vector3i& size, int threads = 1);

}  // namespace clearway
