#pragma once

#include <Eigen/Core>
#include <vector>

namespace clearway {

// PCL's filter, on finite points.

/// Indices, ascending, of the points whose mean distance to their nearest `neighbours` is at most the mean of
/// these distances plus `deviations` times their standard deviation (pcl::StatisticalOutlierRemoval).
/// @param neighbours from 1 to the number of points - 1
std::vector<int> inliers(const std::vector<Eigen::Vector3f>& points, int neighbours, double deviations);

}  // namespace clearway
