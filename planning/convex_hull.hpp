#pragma once

#include <Eigen/Core>
#include <vector>

namespace clearway {

/// The corners of the convex hull of `points`, in their order, doubles removed. Fewer corners only make
/// support queries faster: for points that qhull cannot handle (flat, fewer than five) all of them are kept.
std::vector<Eigen::Vector3d> hull_corners(std::vector<Eigen::Vector3d> points);

}  // namespace clearway
