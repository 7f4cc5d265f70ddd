#pragma once

#include <Eigen/Core>
#include <string>
#include <vector>

#include "mapping/sphere.hpp"

namespace clearway {

/// One painted collision-free volume (CFV): the exact union of its balls, Chong et al. 2008, eq. 2.
/// The voxels of the map are a conservative copy of it (painted voxel => wholly inside one ball).
struct PaintedVolume {
  std::string label;
  std::vector<std::string> critical_parts;  ///< robot parts that must stay inside this volume
  std::vector<Sphere> balls;                ///< in the order painted
  std::vector<double> times;                ///< seconds, one per ball (0 where unknown)

  /// True when `point` (map frame) lies in the closed union of the balls.
  bool contains(const Eigen::Vector3d& point) const;
};

}  // namespace clearway
