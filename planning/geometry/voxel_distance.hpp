#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <span>

#include "mapping/system/instruction_set.hpp"
#include "planning/geometry/shape.hpp"

namespace clearway {

/// A blocked cube that may be near a body.
struct NearVoxel {
  Eigen::Vector3d center;   ///< map frame
  Eigen::Vector3d towards;  ///< middle of the sphere that sees it
  double behind = 0.0;      ///< how much farther it is than the cube nearest to that sphere
};

/// The distance between a body and a voxel.
struct VoxelDistance {
  double distance = 0.0;  ///< between two planes with body and cube on either side: never too large
  Eigen::Vector3d point = Eigen::Vector3d::Zero();  ///< of the body, nearest to the cube
  /// Unit, from the body to the cube; zero where they overlap so much that none is known.
  Eigen::Vector3d normal = Eigen::Vector3d::Zero();
};

/// The distances between one placed body and the cubes of voxels about it, eight side by side: of spheres and
/// capsules in closed form, of hulls by distance_to_cube (one by one). Of cylinders and boxes by projecting
/// to and fro between the two from the cube's point nearest to `towards` (near the body) until little is
/// gained, or they are proved to be farther apart than `enough`: in the worst case, faces that are nearly
/// parallel, the distance is up to 1 % of the cube's edge too short.
class VoxelDistances {
 public:
  /// @param shape must live as long. @param edge of the cubes.
  VoxelDistances(const Shape& shape, const Eigen::Isometry3d& map_from_shape, double edge);

  /// out[i] is the distance to cubes[i], whichever others there are. @pre as many of each
  void to(std::span<const NearVoxel> cubes, double enough, std::span<VoxelDistance> out) const;
  /// The same, bit for bit, with the given instruction set, which the machine must support.
  void to(std::span<const NearVoxel> cubes, double enough, std::span<VoxelDistance> out,
          InstructionSet vectors) const;

 private:
  VoxelDistance proved_distance(const Eigen::Vector3d& cube, double enough) const;

  const Shape& shape_;
  Eigen::Isometry3d map_from_shape_;
  double edge_;
};

}  // namespace clearway
