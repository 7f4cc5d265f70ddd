#pragma once

#include <Eigen/Core>
#include <array>
#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

#include "mapping/voxels/scan_grid.hpp"

namespace clearway {

/// A set of cells, packed: for each tile that holds any, two bits for each cube of 8 x 8 x 8 cells (none,
/// all, some), for each "some" the same for its cubes of 4 x 4 x 4, for each "some" of these its 64 bits;
/// then deflated. A few kilobytes for what one scan touches, because most of it is solid.
class TouchedCells {
 public:
  enum class Kind { free, occupied };

  /// Bytes before deflating that a set may take (64 MiB; a depth image takes about 1 MB at 1 cm).
  static constexpr std::size_t raw_limit = std::size_t{64} << 20U;

  TouchedCells() = default;
  /// The free or the occupied cells of tiles in octree order. A set over raw_limit is left empty, and not
  /// `is_complete`.
  TouchedCells(const std::vector<ScanTile*>& tiles, Kind kind);
  /// From a file: what `packed` and `raw_bytes` gave.
  TouchedCells(std::string packed, std::uint32_t raw_bytes);

  bool contains(const Eigen::Vector3i& cell) const;
  /// Cells in the set.
  std::size_t count() const;

  const std::string& packed() const { return packed_; }
  std::uint32_t raw_bytes() const { return raw_bytes_; }  ///< before deflating

  bool is_complete() const { return complete_; }

  /// False when the bytes are not those of a set of cells; all answers are then "no".
  bool is_sound() const;

 private:
  std::string packed_;
  std::uint32_t raw_bytes_ = 0;
  bool complete_ = true;
};

}  // namespace clearway
