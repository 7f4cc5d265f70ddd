#pragma once

#include <Eigen/Core>
#include <optional>
#include <vector>

namespace clearway {

/// How far apart the points of a thinned surface are, metres: of a cloud of which one point was kept in each
/// cell (PCL's VoxelGrid, centres of voxels), coarser than `fine`. Nothing for points that are nearer to one
/// another or lie on a grid of `fine`, for few, and for those that are strewn at random, as things that stand
/// alone are. Judged by 400 points spread over the cloud: the median distance of the fourth nearest is above
/// 1.05 `fine` and is what is returned; it hardly differs from place to place, or the second nearest is
/// seldom nearer than half of it.
std::optional<double> thinned_spacing(const std::vector<Eigen::Vector3f>& points, double fine);

}  // namespace clearway
