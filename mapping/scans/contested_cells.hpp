#pragma once

#include <cstdint>
#include <memory>
#include <unordered_map>
#include <vector>

#include "mapping/voxels/fused_tree.hpp"
#include "mapping/voxels/scan_grid.hpp"

namespace clearway {

/// Voxels on which scans disagree: one hit something beside them, and none hit them or was believed to have
/// seen through them. Each keeps how many looks through it are not believed yet, at most two.
///
/// A single ray that passes a surface where the poses or the ranges of two scans disagree frees voxels that
/// lie in the surface. Hits beside a voxel are evidence against such a look.
class ContestedCells {
 public:
  /// Weighs a scan before FusedTree::update, after spare_surfaces has noted what it spares:
  /// - a miss of a contested voxel is taken out of `grid`'s free cells, and the voxel is contested once less;
  /// - a voxel that the scan spares and that nobody observed becomes contested, once more each time;
  /// - a voxel that the scan spares and that a single miss made free is unknown again;
  /// - a hit ends it. Voxels that were hit, or seen free by more than one miss, are left alone.
  /// @param threads >= 1; the result does not depend on it.
  void weigh(FusedTree& tree, ScanGrid& grid, int threads);

  /// The number of this scan among those that were counted, from 0.
  std::size_t count_scan() { return scans_++; }

  /// How many looks through this cell are not believed yet: 0, 1 or 2.
  int contested(const Eigen::Vector3i& cell) const;

 private:
  /// Two bits a cell of a tile.
  struct Planes {
    std::array<std::uint64_t, ScanTile::words> once{}, twice{};
  };
  static void weigh_tile(const FusedTree& tree, ScanTile& tile, Planes& planes,
                         std::vector<Eigen::Vector3i>& taken_back);

  std::unordered_map<std::uint64_t, std::unique_ptr<Planes>> planes_;
  std::size_t scans_ = 0;
};

}  // namespace clearway
