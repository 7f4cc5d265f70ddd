#pragma once

#include <Eigen/Core>
#include <optional>
#include <vector>

#include "mapping/snapshot.hpp"

namespace clearway {

/// A stretch of a ray through voxels of one state; distances from the ray's origin, metres.
struct RayRun {
  VoxelState state = VoxelState::unknown;
  double from = 0.0, to = 0.0;
};

/// What a ray passes until it meets a blocked voxel (occupied or conflict) or leaves what the map holds.
struct RayReport {
  std::vector<RayRun> runs;      ///< in order, without gaps, from 0 to where the ray ends
  std::optional<Voxel> blocked;  ///< the first blocked voxel; the last run ends where the ray enters it
  double distance = 0.0;         ///< to where it enters that voxel, or to the end of the map
};

/// Walks the voxels along a ray (Amanatides and Woo 1987; no step is summed up, so no error grows).
/// @param direction of any length but 0. @throws std::invalid_argument when it or the origin is not finite,
///        the direction is 0, or the origin has no voxel.
RayReport ray_states(const Snapshot& map, const Eigen::Vector3d& origin, const Eigen::Vector3d& direction);

}  // namespace clearway
