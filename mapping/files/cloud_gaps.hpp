#pragma once

#include <Eigen/Core>
#include <vector>

namespace clearway {

/// Empty voxels that a surface passes of which points are about as far apart as voxels are wide: those that
/// lie between two of the cloud's points. Two points are joined where they are at most 1.95 edges apart and
/// no other one is within 0.35 of their distance of the middle between them (a lens of the empty-ball graph,
/// Gabriel and Sokal 1969, Kirkpatrick and Radke 1985), so that points of one dense surface join their
/// neighbours alone. A voxel counts of which the join passes a tenth of an edge or more; centres of voxels
/// join none. Points in a quarter of an edge count once. Points in the 26 voxels round it
/// are looked at. In rising order; none holds a point.
/// @param points finite ones; @param cells the voxel of each, metres / `edge` rounded down
std::vector<Eigen::Vector3i> cells_between(const std::vector<Eigen::Vector3f>& points,
                                           const std::vector<Eigen::Vector3i>& cells, double edge);

}  // namespace clearway
