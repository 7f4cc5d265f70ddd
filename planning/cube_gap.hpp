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

/// The gaps between one placed body and the cubes of voxels about it: of spheres and capsules in closed form,
/// of hulls by distance_to_cube. Of cylinders and boxes by projecting to and fro between the two from the
/// cube's point nearest to `towards` (near the body) until little is gained, or they are proved to be farther
/// apart than `enough`: in the worst case, faces that are nearly parallel, the distance is up to 1 % of the
/// cube's edge too short.
class CubeGaps {
 public:
  /// @param shape must live as long. @param edge of the cubes.
  CubeGaps(const Shape& shape, const Eigen::Isometry3d& map_from_shape, double edge);

  CubeGap to(const Eigen::Vector3d& cube, const Eigen::Vector3d& towards, double enough) const;

 private:
  CubeGap round_gap(const Eigen::Vector3d& cube) const;
  CubeGap projected_gap(const Eigen::Vector3d& cube, const Eigen::Vector3d& towards, double enough) const;
  CubeGap proved_gap(const Eigen::Vector3d& cube, double enough) const;
  Eigen::Vector3d offset_to(const Eigen::Vector3d& point) const;

  const Shape& shape_;
  Eigen::Isometry3d map_from_shape_;
  double half_;                      ///< edge
  Eigen::Vector3d middle_, axis_;    ///< of the body, and its z; map frame
  double half_length_ = 0.0, size_;  ///< of its axis, and of the coordinates, for rounding
};

}  // namespace clearway
