#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <limits>
#include <memory>
#include <vector>

#include "mapping/system/instruction_set.hpp"
#include "mapping/voxels/scan_grid.hpp"

namespace clearway {

/// Where one ray of a scan ends, map frame, metres.
struct RayEnd {
  Eigen::Vector3f point = Eigen::Vector3f::Zero();
  /// The ray frees a voxel only when it leaves that voxel within this length from the origin, metres; the
  /// voxel of the origin itself is always freed by a ray that leaves it. Infinite: up to the end.
  float reach = std::numeric_limits<float>::infinity();
};

/// The rays of one scan. Origin and end points must have voxels in the tree (FusedTree::cell).
struct ScanRays {
  Eigen::Vector3f origin = Eigen::Vector3f::Zero();
  std::vector<RayEnd> ends;
};

/// Memory that ray casting keeps from one scan to the next: a byte a cell of the box that the rays cross, at
/// most 128 MB a thread.
class RayWorkspace {
 public:
  RayWorkspace();
  ~RayWorkspace();
  RayWorkspace(RayWorkspace&&) noexcept;
  RayWorkspace& operator=(RayWorkspace&&) noexcept;

  struct Windows;
  Windows& windows() { return *windows_; }

 private:
  std::unique_ptr<Windows> windows_;
};

/// Marks as free in `grid` every voxel that octomap::OcTree::computeRayKeys lists for these rays: those
/// before the voxel of the end, which is not marked. Bit for bit the same arithmetic (Amanatides and Woo 1987
/// in double precision). Does not touch the occupied bits.
/// @param resolution edge of a voxel, metres. @param threads >= 1; the result does not depend on it.
void cast_rays(const ScanRays& rays, double resolution, int threads, InstructionSet set,
               RayWorkspace& workspace, ScanGrid& grid);

}  // namespace clearway
