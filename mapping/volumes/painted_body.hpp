#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <memory>
#include <vector>

#include "mapping/field/blocked_space.hpp"
#include "mapping/scans/scan.hpp"
#include "mapping/snapshot.hpp"

namespace clearway {

/// A solid cylinder with flat ends, map frame.
struct Cylinder {
  Eigen::Vector3d a = Eigen::Vector3d::Zero();
  Eigen::Vector3d b = Eigen::Vector3d::Zero();
  double radius = 0.0;
};

/// Whether simple bodies lie wholly inside the painted voxels of some volumes: the CFV check of Chong et al.
/// 2008, 4.1. The voxels decide, as they do for planners, and a voxel that is sensed occupied blocks; so what
/// is inside here is inside the exact union of spheres, and what is nearer to its surface than a voxel or two
/// is refused. The distance field decides the clear cases, the exact body against voxel cubes the rest.
/// Immutable and safe to read from many threads.
class PaintedSpace {
 public:
  /// @param volumes  bit i: volume i counts; a body must lie in the voxels of these together.
  /// @throws std::invalid_argument when the painted box exceeds the memory limit of fields.
  PaintedSpace(const Snapshot& map, std::uint16_t volumes);

  /// @throws std::invalid_argument for a body that is not finite or whose radius is not > 0.
  bool contains(const Sphere& sphere) const;
  bool contains(const Capsule& capsule) const;
  bool contains(const Cylinder& cylinder) const;

 private:
  struct Rod;
  bool holds(const Rod& rod) const;
  bool holds_piece(const Rod& rod, double from, double to) const;

  std::shared_ptr<const BlockedSpace> space_;  ///< null when nothing is painted
};

enum class Containment : std::uint8_t { inside, outside, undecided };

/// The same question to the exact union of spheres. `inside`: the body was cut into cubes each of which lies
/// in one sphere; `outside`: a point of the body lies in no sphere; `undecided`: nearer to the union's
/// surface than `tolerance` (metres, > 0), or more than a million cubes.
/// @throws std::invalid_argument for a body or tolerance that is out of range.
Containment union_contains(const std::vector<Sphere>& spheres, const Capsule& capsule, double tolerance);
Containment union_contains(const std::vector<Sphere>& spheres, const Cylinder& cylinder, double tolerance);

}  // namespace clearway
