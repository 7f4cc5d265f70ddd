#pragma once

#include <cstdint>
#include <optional>

#include "mapping/field/blocked_cells.hpp"
#include "mapping/field/distance_axes.hpp"
#include "mapping/field/tiled_cells.hpp"

namespace clearway {

/// The squared distances of a block of cells to its blocked cubes (see DistanceAxes), and what is needed
/// to follow a change without starting again: the cells' bits, and the distances within each plane of y and
/// z. Two versions share what they have in common. Immutable: safe to read from many threads.
class DistanceLayers {
 public:
  /// From nothing, on so many threads, which make no difference. Without `keep_planes` it takes half the
  /// memory and cannot be updated.
  /// @param threads >= 1, here and below.
  DistanceLayers(BlockedCells blocked, std::uint16_t cap, bool keep_planes, int threads = 1);

  /// The layers of other bits of the same size: equal, cell for cell, to those made from nothing. Only what
  /// the change reaches is computed, line by line: an axis is done again where the one before it really
  /// changed.
  /// @param before must keep its planes.
  DistanceLayers(const DistanceLayers& before, BlockedCells blocked, int threads = 1);

  bool keeps_planes() const { return planes_.has_value(); }
  std::uint16_t cap() const { return cap_; }
  const BlockedCells& blocked() const { return blocked_; }

  /// min(cap, squared distance in half voxels); 0 in blocked cells only.
  std::uint16_t squared(int x, int y, int z) const { return distances_.at(x, y, z); }
  const TiledCells& distances() const { return distances_; }
  /// The squared distances of the 32 cells from x = 32 lane; those beyond the block mean nothing.
  const std::uint16_t* line(int lane, int y, int z) const { return distances_.line(lane, y, z); }

  std::size_t bytes() const;  ///< in memory, tiles shared with other versions included

 private:
  std::uint16_t cap_;
  BlockedCells blocked_;
  std::optional<TiledCells> planes_;
  TiledCells distances_;
};

}  // namespace clearway
