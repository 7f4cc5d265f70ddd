#pragma once

#include <Eigen/Core>
#include <vector>

#include "datasets/descriptions/scene.hpp"
#include "mapping/field/blocked_space.hpp"
#include "mapping/scans/scan.hpp"

namespace clearway {

/// The middle of the voxel that the point lies in: where a scan that is discretized ends a ray to it.
Eigen::Vector3d voxel_middle(const Eigen::Vector3d& point, double resolution);

/// Points on the surface of a solid, map frame, so dense that no point of the surface is farther than
/// `spacing` metres from one of them; its edges and corners are met.
std::vector<Eigen::Vector3d> surface_points(const SceneShape& solid, double spacing);

/// What a range sensor at `from` sees of the solids, without noise, for a map of voxels of `resolution`: rays
/// all around, at `range` no farther apart than a voxel, and rays to points of the solids' surfaces half a
/// voxel apart, so that no surface slips between two rays. A ray that meets nothing within the range has its
/// point beyond it.
/// @param from,range,resolution metres, map frame
Scan scan_solids(const std::vector<SceneShape>& solids, const Eigen::Vector3d& from, double range,
                 double resolution);

/// What the same sensor sees of a map of an otherwise unknown world: each occupied voxel of which no other
/// hides the middle, or that of a face, and rays all around that meet nothing within the range. Each ends
/// in its voxel, and none crosses one that is occupied: inserted as they are (not discretized), none carves
/// what stands there. The sensor stands in none of them; its rays begin within a five-hundredth of a voxel of
/// it.
/// @param occupied voxels of `resolution`, the `not_occupied` requirement
Scan scan_voxels(const BlockedSpace& occupied, const Eigen::Vector3d& from, double range, double resolution);

/// A scan of solids before something else.
struct SolidScan {
  Scan scan;
  std::size_t on_solids = 0;  ///< how many of its points lie on the solids: the first ones
};

/// `still` (see scan_voxels, same arguments) with solids before those voxels: rays that meet a solid end
/// there, and there are rays to the voxels of the solids' surfaces, but for those that would carve one of the
/// voxels.
SolidScan scan_solids_before(const Scan& still, const std::vector<SceneShape>& solids,
                             const BlockedSpace& occupied, double range, double resolution);

}  // namespace clearway
