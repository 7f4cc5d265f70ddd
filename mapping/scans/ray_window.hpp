#pragma once

#include <Eigen/Geometry>
#include <cstdint>
#include <cstdlib>
#include <memory>
#include <vector>

#include "mapping/scans/ray_start.hpp"
#include "mapping/voxels/scan_grid.hpp"

namespace clearway {

/// One byte a cell over a box of cells, 1 where a ray passed. Rows run along x; a step along an axis is the
/// addition of a constant to an index. Rows and layers hold an odd number of cache lines, so that rays along
/// y and z do not fall into one cache set. All bytes are 0 between scans.
class RayWindow {
 public:
  static constexpr std::int64_t most_cells = std::int64_t{1} << 27U;
  /// Cells left free beside the rays' own: rounding may carry a ray past its end, by one cell an axis.
  static constexpr int margin = 2;

  /// Bytes that a window over `box` (cells, inclusive) takes.
  static std::int64_t bytes_of(const Eigen::AlignedBox3i& box);

  /// Covers the cells of `box` (inclusive) and the margin. A window of `few` rays keeps where they pass, so
  /// that the rest need not be read: each is to be told by expect_ray().
  void cover(const Eigen::AlignedBox3i& box, bool few = false);

  /// Of few rays: the blocks near the line between the middles of two cells may be marked.
  void expect_ray(const Eigen::Vector3i& from, const Eigen::Vector3i& to);
  /// False when no cell of the block of 64 x 8 x 8 cells from `first` on can be marked.
  bool may_be_marked(const Eigen::Vector3i& first) const {
    return !is_few_ || expected_[block_of(first)] != 0;
  }

  std::int64_t index(const Eigen::Vector3i& cell) const {
    const Eigen::Vector3i local = cell - corner_;
    return local.x() + local.y() * stride_[1] + local.z() * stride_[2];
  }
  std::int64_t stride(std::size_t axis) const { return stride_[axis]; }
  std::uint8_t* cells() { return cells_.get(); }

  static constexpr int block_edge = 8;  ///< along y and z; 64 along x

  /// First cell, a multiple of 64 along x and of 32 along y and z; the window holds whole tiles.
  const Eigen::Vector3i& corner() const { return corner_; }
  /// Cells along each axis, multiples of 64 and 32.
  const Eigen::Vector3i& size() const { return size_; }

 private:
  struct Free {
    void operator()(std::uint8_t* memory) const { std::free(memory); }
  };
  std::unique_ptr<std::uint8_t, Free> cells_;
  std::int64_t capacity_ = 0;
  Eigen::Vector3i corner_ = Eigen::Vector3i::Zero(), size_ = Eigen::Vector3i::Zero();
  std::int64_t stride_[3] = {1, 0, 0};
  bool is_few_ = false;
  std::vector<std::uint8_t> expected_;  ///< of each block

  std::size_t block_of(const Eigen::Vector3i& cell) const {
    const Eigen::Vector3i at = cell - corner_;
    return static_cast<std::size_t>((at.x() >> 6) +
                                    (size_.x() >> 6) * ((at.y() >> 3) + (size_.y() >> 3) * (at.z() >> 3)));
  }
};

/// Reads the bytes of 64 x 4 x 4 cells from `first` on, clears them, and returns them as 16 words of
/// 4 x 4 x 4 cells in ScanTile's order, added (by OR) to `words`. False when all were 0.
bool collect_words(std::uint8_t* first, std::int64_t stride_y, std::int64_t stride_z, InstructionSet set,
                   std::uint64_t* words);

/// Reads the bytes of 64 x 4 x 4 cells from `first` on, a multiple of 64, into a mask for each row (y, z), at
/// y + 4 z, and clears them. False when all were 0.
bool take_masks(std::uint8_t* first, std::int64_t stride_y, std::int64_t stride_z, InstructionSet set,
                std::uint64_t (&masks)[16]);

/// Sixteen rays side by side, each a RayState; what the walkers of each instruction set take.
struct RayPack {
  static constexpr std::size_t size = 16;
  /// A ray is safe for as many steps as it has borders to cross within its reach, less 7: 3 for the fractions
  /// that are counted in, 3 for rounding (one border an axis at most), and one more.
  static constexpr double unsafe_steps = 7.0;
  alignas(64) double next[3][size];
  alignas(64) double delta[3][size];
  alignas(64) std::int64_t step[3][size];  ///< of the window's index
  alignas(64) std::int64_t at[size];       ///< index of the present cell
  alignas(64) std::int64_t end[size];
  alignas(64) double reach[size];
  alignas(64) std::int64_t safe[size];  ///< steps that cannot end the ray, whatever the rounding
  unsigned active;                      ///< bit i: lane i holds a ray
  std::int64_t origin;                  ///< index of the origin's cell; idle lanes mark it again
};

/// Fills a pack with rays that end inside of the window; those that end in the origin's cell stay idle.
void fill_pack(const RayStarter& starter, const RayWindow& window,
               const std::array<RayEnd, RayPack::size>& rays, InstructionSet set, RayPack& pack);

/// Marks with 1 the bytes of all cells that the rays of a pack free, the origin's left out.
void walk_pack(RayPack& pack, std::uint8_t* cells, InstructionSet set);

}  // namespace clearway
