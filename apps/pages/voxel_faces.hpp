#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "apps/pages/voxel_bricks.hpp"

namespace clearway {

/// Whether a coarser cell is drawn where any of its voxels is of the state, as what blocks is, or only where
/// all are: so that nothing looks free that is not.
bool is_drawn_where_any(std::string_view state);

/// The voxels of one state, as an octree stores them: a pruned leaf is larger than one voxel.
struct PageVoxels {
  std::string state;  ///< "painted", "occupied", "conflict" or "seen_free"
  double size = 0.0;  ///< edge of the finest voxel, metres
  VoxelBricks cells{};
  std::uint64_t count = 0;               ///< finest voxels: a pruned leaf counts as all its voxels
  bool any = is_drawn_where_any(state);  ///< coarser cells are drawn where any voxel is of the state

  /// Adds a leaf, a cube of 2^k voxels an edge that is aligned to a multiple of its own edge.
  /// @param center, edge map frame, metres
  /// @throws std::invalid_argument when it is no octree's cube. Where it overlaps another leaf either this or
  ///         exposed_faces throws.
  void add(const Eigen::Vector3d& center, double edge);
};

/// A rectangle of exposed voxel faces in one plane. Coordinates count finest voxels from the corner of the
/// octree's space (-32768 voxels from the map's origin), so that all are non-negative.
struct VoxelQuad {
  std::uint16_t direction = 0;          ///< 0 -x, 1 +x, 2 -y, 3 +y, 4 -z, 5 +z: the outward normal
  std::uint16_t layer = 0;              ///< the voxels' coordinate along the normal's axis a
  std::uint16_t u = 0, v = 0;           ///< lowest voxel along axes (a+1)%3 and (a+2)%3
  std::uint32_t width = 1, height = 1;  ///< voxels along u and v

  friend bool operator==(const VoxelQuad&, const VoxelQuad&) = default;
};

/// The octree coordinate of the map's origin.
inline constexpr int kOriginVoxel = 32768;

/// The surface of a set of voxels: every face between a voxel of the set and one outside it, once, faces of
/// one plane merged greedily into rectangles; sorted by direction, layer, v, u. Works brick by brick, and
/// splits a large leaf only where smaller ones touch it, so the cost follows the surface.
/// @throws std::invalid_argument when two leaves overlap.
std::vector<VoxelQuad> exposed_faces(const PageVoxels& voxels);

/// How many faces of single cells the surface has; of a large leaf each undivided square counts as one.
std::uint64_t count_faces(const VoxelBricks& cells);

}  // namespace clearway
