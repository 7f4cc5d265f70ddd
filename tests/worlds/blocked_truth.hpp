#pragma once

#include <algorithm>
#include <cmath>
#include <vector>

#include "mapping/snapshot.hpp"

namespace clearway::worlds {

/// Slow and obvious twin of a BlockedSpace: cell by cell from the snapshot's voxels.
class BlockedTruth {
 public:
  BlockedTruth(const Snapshot& map, const Requirement& requirement, const Eigen::AlignedBox3d& region)
      : resolution_(map.resolution()),
        region_(region),
        outside_blocked_(requirement.policy != Policy::not_occupied) {
    const Eigen::Vector3i size = (region.sizes() / resolution_).array().round().cast<int>();
    first_ = (region.min() / resolution_).array().round().cast<int>();
    for (int z = 0; z < size.z(); ++z) {
      for (int y = 0; y < size.y(); ++y) {
        for (int x = 0; x < size.x(); ++x) {
          const Eigen::Vector3i cell = first_ + Eigen::Vector3i(x, y, z);
          const Voxel voxel = map.voxel(center(cell));
          if (!allows(requirement, voxel.state, voxel.volumes)) blocked_.push_back(cell);
        }
      }
    }
  }

  Eigen::Vector3d center(const Eigen::Vector3i& cell) const {
    return (cell.cast<double>().array() + 0.5) * resolution_;
  }
  const std::vector<Eigen::Vector3i>& blocked() const { return blocked_; }
  bool outside_blocked() const { return outside_blocked_; }

  double distance_to_cube(const Eigen::Vector3d& point, const Eigen::Vector3i& cell) const {
    const Eigen::Array3d gap = ((point - center(cell)).array().abs() - 0.5 * resolution_).max(0.0);
    return gap.matrix().norm();
  }

  /// Distance to the nearest blocked cube; beyond the region, blocked space is everything under a policy that
  /// blocks the unknown.
  double distance(const Eigen::Vector3d& point) const {
    double nearest = HUGE_VAL;
    if (outside_blocked_) {
      const Eigen::Array3d low = (point - region_.min()).array(), high = (region_.max() - point).array();
      nearest = std::max(0.0, std::min(low.minCoeff(), high.minCoeff()));
    }
    for (const Eigen::Vector3i& cell : blocked_) {
      if (nearest == 0.0) break;
      nearest = std::min(nearest, distance_to_cube(point, cell));
    }
    return nearest;
  }

 private:
  double resolution_;
  Eigen::AlignedBox3d region_;
  bool outside_blocked_;
  Eigen::Vector3i first_;
  std::vector<Eigen::Vector3i> blocked_;
};

}  // namespace clearway::worlds
