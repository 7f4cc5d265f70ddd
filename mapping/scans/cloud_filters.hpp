#pragma once

#include <Eigen/Core>
#include <vector>

namespace clearway {

// PCL's filters, on finite points.

/// The centroid of the points in each cube that holds any (pcl::VoxelGrid).
/// @param edge of a cube, metres, > 0; the cubes of the cloud's box must be fewer than 2^31
std::vector<Eigen::Vector3f> one_point_per_cube(const std::vector<Eigen::Vector3f>& points, double edge);

/// Indices, ascending, of the points whose mean distance to their nearest `neighbours` is at most the mean of
/// these distances plus `deviations` times their standard deviation (pcl::StatisticalOutlierRemoval).
/// @param neighbours from 1 to the number of points - 1
std::vector<int> inliers(const std::vector<Eigen::Vector3f>& points, int neighbours, double deviations);

}  // namespace clearway
