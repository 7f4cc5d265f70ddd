#pragma once

#include <vector>

#include "mapping/scans/scan.hpp"

namespace clearway {

/// The points of one scan that survive a filter, map frame.
struct FilteredPoints {
  Eigen::Vector3d origin = Eigen::Vector3d::Zero();  ///< where the rays start
  std::vector<Eigen::Vector3f> points;               ///< finite; nearer or farther than max_range
  /// Where points were thinned: all of them, which were hits, too.
  std::vector<Eigen::Vector3f> thinned = {};
  std::vector<Eigen::Vector3f> in_bodies = {};  ///< dropped, for a body holds them
  std::size_t dropped_invalid = 0;              ///< NaN or infinite
  std::size_t dropped_filter = 0;
};

/// Transforms a scan into the map frame and drops what is not finite, nearer than min_range, outside the crop
/// box, inside a body, or thinned away. Rays beyond max_range stay: they still free space. Thinning keeps one
/// point per cube that holds any, that nearest to their centroid. Last, statistical outliers go
/// (pcl::StatisticalOutlierRemoval), among the points within max_range.
/// @throws std::invalid_argument naming the field of the filter that is negative or not finite.
FilteredPoints filter_points(const Scan& scan, const ScanFilter& filter);

/// True when `point` lies in the closed capsule.
bool contains(const Capsule& capsule, const Eigen::Vector3d& point);

}  // namespace clearway
