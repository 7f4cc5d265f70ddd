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

/// A thinned surface among other things.
struct ThinnedPart {
  double apart = 0.0;               ///< m, as thinned_spacing returns it of these points alone
  std::vector<std::size_t> points;  ///< their indices, rising; of points on one another one
};

/// The thinned surfaces of a cloud that may hold dense ones too: of the points with fewer than two others
/// within 1.05 `fine`, groups of neighbours that are as far apart, each judged as thinned_spacing judges a
/// cloud; without lines of points (a lidar's rings) and without groups that others are scattered among.
/// Ordered by a point of each.
std::vector<ThinnedPart> thinned_parts(const std::vector<Eigen::Vector3f>& points, double fine);

/// Points that are strewn so thinly that voxels of `fine` may miss a surface of them although near ones are
/// joined (cells_between): the fourth nearest is 0.7 to 3 `fine` away, and they are not evenly apart. `apart`
/// is its median. Nothing where they are less than a twentieth of the cloud. Measured over planes at all
/// tilts: holes up to 3 points for a voxel's face, none from 4 on, where this still speaks of some.
std::optional<ThinnedPart> strewn_part(const std::vector<Eigen::Vector3f>& points, double fine);

}  // namespace clearway
