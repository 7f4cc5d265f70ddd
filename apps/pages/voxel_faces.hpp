#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <string>
#include <vector>

namespace clearway {

/// The leaves of one voxel state, as an octree stores them: a pruned leaf is larger than one voxel.
/// Map frame, metres. Every leaf is a cube of 2^k voxels along an edge, aligned to a multiple of its own
/// edge.
struct PageVoxels {
  std::string state;                     ///< "painted", "occupied", "conflict" or "seen_free"
  double size = 0.0;                     ///< edge of the finest voxel, metres
  std::vector<Eigen::Vector3f> centers;  ///< of the leaves
  std::vector<float> sizes;              ///< edges of the leaves, metres; empty when all have `size`
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
/// one plane merged greedily into rectangles; sorted by direction, layer, v, u. The faces are found leaf by
/// leaf (a large leaf is split only where smaller leaves touch it), so the cost follows the surface.
/// @throws std::invalid_argument when a leaf is not an octree's cube, or two leaves overlap.
std::vector<VoxelQuad> exposed_faces(const PageVoxels& voxels);

/// Finest voxels in the set: a pruned leaf counts as all its voxels.
std::uint64_t count_voxels(const PageVoxels& voxels);

}  // namespace clearway
