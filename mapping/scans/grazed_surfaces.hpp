#pragma once

#include <Eigen/Core>
#include <array>
#include <cstdint>
#include <memory>
#include <unordered_map>
#include <vector>

#include "mapping/voxels/fused_tree.hpp"
#include "mapping/voxels/scan_grid.hpp"

namespace clearway {

/// Surfaces that a scan sees edge-on: a board at the height of the camera. Its rays pass through what the
/// voxels of the surface hold besides it, over a long way, and say nothing of the surface. So such a look
/// takes nothing from a voxel that was hit from elsewhere; from where it was hit it does, since what was seen
/// from there would be seen again.
class GrazedSurfaces {
 public:
  /// Takes occupied voxels that the scan sees edge-on and that were hit from elsewhere out of `grid`'s free
  /// cells, and notes from where the scan hits its own. To be called before FusedTree::update.
  /// @param origin of the scan's rays, metres. @param threads >= 1; the result does not depend on it
  void weigh(const FusedTree& tree, const Eigen::Vector3d& origin, ScanGrid& grid, int threads);

 private:
  /// From where the voxels of a word of a tile were hit.
  struct View {
    Eigen::Matrix<std::int8_t, 3, 1> way{0, 0, 0};  ///< of the first ray that hit, times 127
    enum : std::uint8_t { never, one, several } from = never;

    /// All hits came along this way, within 3 degrees.
    bool is_only(const Eigen::Vector3d& other) const;
    void add(const Eigen::Vector3d& other);

   private:
    bool is_same_way(const Eigen::Vector3d& other) const;
  };
  using Views = std::array<View, ScanTile::words>;

  void spare(const FusedTree& tree, const Eigen::Vector3d& origin, ScanTile& tile) const;
  void note_hits(const ScanTile& tile, const Eigen::Vector3d& origin);

  std::unordered_map<std::uint64_t, std::unique_ptr<Views>> views_;  ///< of tiles that were hit
};

/// Whether an occupied voxel lies in a layer of occupied ones, at most three voxels and 12 cm thick, along
/// which the line of sight to it goes, within some 2.5 degrees. @param origin metres over the resolution
bool is_seen_edge_on(const FusedTree& tree, const Eigen::Vector3i& cell, const Eigen::Vector3d& origin);

}  // namespace clearway
