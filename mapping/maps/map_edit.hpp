#pragma once

#include <Eigen/Geometry>

#include "mapping/snapshot.hpp"

namespace clearway {

// Maps made of maps. None calls a voxel free that its sources do not; the exact spheres go with the voxels,
// and painted voxels lie in the union of the spheres that remain.
//
// Of the times at which voxels were last seen, merge keeps the later (and so supposes that the scans of both
// maps have times of one clock, as recordings with real dates do), crop those of the box, and coarsen the
// earliest look at any of the voxels that become one. The newest look, from which ages count back, is that of
// all.

/// Both maps in one. No obstacle is lost: a voxel that either map calls occupied is occupied, or a conflict
/// where either painted it, and has the higher log-odds of the two; one that both saw and neither calls
/// occupied has the lower. So neither the order of maps nor a scan that is in both makes a difference.
/// Painted volumes of the same label become one (spheres that both hold count once).
/// @throws std::invalid_argument when resolution, occupancy threshold or the critical parts of a common
/// volume
///         differ, or there would be more than 15 volumes.
Snapshot merge(const Snapshot& map, const Snapshot& other);

/// The same map, which does not know when its voxels were last seen: so policies that ask for it refuse it.
Snapshot without_times(const Snapshot& map);

/// The map with these volumes painted, as FreeSpaceMap::paint paints each sphere: what lies wholly inside of
/// one is painted, and a conflict where it is occupied. Volumes become one with those of their label, as
/// merge does it.
/// @throws std::invalid_argument as merge for the volumes, and as FreeSpaceMap::paint for a sphere that is
/// none
Snapshot with_painted(const Snapshot& map, const std::vector<PaintedVolume>& volumes);

/// The voxels of a box, snapped outwards to voxels; all else is unknown. Spheres that do not reach the box
/// go; the others stay whole.
/// @throws std::invalid_argument for an empty or non-finite box.
Snapshot crop(const Snapshot& map, const Eigen::AlignedBox3d& box);

/// The same map in voxels of `resolution`, conservatively: a coarse voxel is
///   painted by a volume when all of its voxels are;
///   occupied (or a conflict, when it is painted) when any of its voxels is;
///   seen free when all of its voxels were observed and none is occupied; else unknown, if not painted.
/// @throws std::invalid_argument unless `resolution` is 2, 4, 8 ... times the map's, and at most 100 m.
Snapshot coarsen(const Snapshot& map, double resolution);

}  // namespace clearway
