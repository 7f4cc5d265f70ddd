#pragma once

#include <Eigen/Core>
#include <array>
#include <cstddef>
#include <vector>

#include "mapping/field/distance_transform.hpp"

namespace clearway {

/// The voxels of one painted volume in a block of cells: 0 where a part that must stay in the volume may not
/// be, with a margin of one such cell all around.
struct VolumeVoxels {
  Eigen::Vector3i first = Eigen::Vector3i::Zero();  ///< cell of the block's corner
  double resolution = 0.0;
  DistanceBlock block;

  Eigen::Vector3i cell(std::size_t index) const;
  Eigen::Vector3d center(std::size_t index) const {
    return (cell(index).cast<double>().array() + 0.5) * resolution;
  }
  /// Steps in `block.squared` to the six cells that share a face.
  std::array<std::ptrdiff_t, 6> face_steps() const;
};

/// The cells of each enclosed pocket: blocked, connected over faces, not connected to the margin. In order of
/// their first cells.
std::vector<std::vector<std::size_t>> find_pockets(const VolumeVoxels& voxels);

/// Where two parts of the volume meet as the spheres that must pass grow smaller.
struct PartsMeet {
  std::size_t cell = 0;
  double level = 0.0;                  ///< distance from its centre to the nearest blocked cube, voxels
  double smaller = 0.0, larger = 0.0;  ///< largest such distance in either part, voxels
};

/// Face-connected parts of the volume and the necks in them.
struct VolumeParts {
  std::vector<std::size_t> sizes;  ///< voxels, largest first
  std::vector<PartsMeet> necks;    ///< narrowest first
};

/// The merge tree of the distance field: cells join in order of falling distance, and where two parts meet
/// whose largest distances both exceed the present one clearly, there is a neck.
/// Precondition: transform_distances(voxels.block) was called.
/// @param ratio  a neck's distance is at most this share of the largest distance of either part, and one
///               voxel less, for a smooth tube waves by nearly that much.
VolumeParts find_parts(const VolumeVoxels& voxels, double ratio);

}  // namespace clearway
