#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>

#include "planning/shape.hpp"

namespace clearway {

/// The gap between a body and a voxel cube.
struct CubeGap {
  double distance = 0.0;  ///< between two planes with body and cube on either side: never too large
  Eigen::Vector3d point = Eigen::Vector3d::Zero();   ///< of the body, nearest to the cube
  Eigen::Vector3d normal = Eigen::Vector3d::Zero();  ///< unit, from the body to the cube; zero: they overlap
};

/// Of spheres, capsules and hulls by distance_to_cube. Of cylinders and boxes by projecting to and fro
/// between the two from the cube's point nearest to `towards` (near the body) until little is gained, or they
/// are proved to be farther apart than `enough`: in the worst case, faces that are nearly parallel, the
/// distance is up to 1 % of the cube's edge too short.
CubeGap cube_gap(const Shape& shape, const Eigen::Isometry3d& map_from_shape, const Eigen::Vector3d& cube,
                 double edge, const Eigen::Vector3d& towards, double enough);

}  // namespace clearway
