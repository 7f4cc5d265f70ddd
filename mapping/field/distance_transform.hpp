#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "mapping/field/distance_axes.hpp"

namespace clearway {

/// A block of cells with their squared distances, x fastest. Rows are padded to a multiple of `lane` cells.
struct DistanceBlock {
  static constexpr int lane = lane_cells;

  int nx = 0, ny = 0, nz = 0;
  int stride = 0;         ///< cells from one row to the next, >= nx
  std::uint16_t cap = 0;  ///< distances are truncated here
  std::vector<std::uint16_t> squared;

  DistanceBlock() = default;
  /// All cells start at `cap` (nothing blocked).
  DistanceBlock(int nx, int ny, int nz, std::uint16_t cap);

  std::size_t index(int x, int y, int z) const {
    return static_cast<std::size_t>(x) +
           static_cast<std::size_t>(stride) *
               (static_cast<std::size_t>(y) + static_cast<std::size_t>(ny) * static_cast<std::size_t>(z));
  }
};

/// Exact truncated distance transform: on entry cells are 0 (blocked) or `cap`; on return each holds
///   min(cap, min over blocked cells b of the sum over axes of max(2|delta|-1, 0)^2),
/// which is the squared distance from the cell's centre to the nearest blocked *cube* in half voxels.
void transform_distances(DistanceBlock& block);

}  // namespace clearway
