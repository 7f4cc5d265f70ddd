#pragma once

#include <Eigen/Core>

#include "mapping/voxels/eigen_layout.hpp"

namespace clearway {

/// A sphere in the map frame, metres: S_i(c_i, r_0) of Chong et al. 2008, eq. 2.
struct Sphere {
  Eigen::Vector3d center = Eigen::Vector3d::Zero();
  double radius = 0.0;
};

}  // namespace clearway
