#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <span>

#include "mapping/field/distance_axes.hpp"
#include "planning/geometry/shape.hpp"

namespace clearway {

/// A blocked cube that may be near a body.
struct BodyCube {
  Eigen::Vector3d center;   ///< map frame
  Eigen::Vector3d towards;  ///< middle of the ball that sees it
  double behind = 0.0;      ///< how much farther it is than the cube nearest to that ball
};

/// The gap between a body and a voxel cube.
struct CubeGap {
  double distance = 0.0;  ///< between two planes with body and cube on either side: never too large
  Eigen::Vector3d point = Eigen::Vector3d::Zero();  ///< of the body, nearest to the cube
  /// Unit, from the body to the cube; zero where they overlap so much that none is known.
  Eigen::Vector3d normal = Eigen::Vector3d::Zero();
};

/// The gaps between one placed body and the cubes of voxels about it, eight side by side: of spheres and
/// capsules in closed form, of hulls by distance_to_cube (one by one). Of cylinders and boxes by projecting
/// to and fro between the two from the cube's point nearest to `towards` (near the body) until little is
/// gained, or they are proved to be farther apart than `enough`: in the worst case, faces that are nearly
/// parallel, the distance is up to 1 % of the cube's edge too short.
class CubeGaps {
 public:
  /// @param shape must live as long. @param edge of the cubes.
  CubeGaps(const Shape& shape, const Eigen::Isometry3d& map_from_shape, double edge);

  /// out[i] is the gap to cubes[i], whichever others there are. @pre as many of each
  void to(std::span<const BodyCube> cubes, double enough, std::span<CubeGap> out) const;
  /// The same, bit for bit, with registers of one's choice, which the machine must have.
  void to(std::span<const BodyCube> cubes, double enough, std::span<CubeGap> out, Vectors vectors) const;

 private:
  CubeGap proved_gap(const Eigen::Vector3d& cube, double enough) const;

  const Shape& shape_;
  Eigen::Isometry3d map_from_shape_;
  double edge_;
};

}  // namespace clearway
