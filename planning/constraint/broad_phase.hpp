#pragma once

#include <Eigen/Core>
#include <span>
#include <vector>

#include "mapping/field/blocked_space.hpp"
#include "mapping/voxels/sphere.hpp"
#include "planning/robot/kinematics.hpp"

namespace clearway {

/// A sphere of a body's cover that is near blocked space.
struct NearSphere {
  int body = 0;           ///< as they were added
  bool is_close = false;  ///< nearer than `close` of its body
  double radius = 0.0;
  double reach = 0.0;      ///< of its body: metres from its surface
  Eigen::Vector3d center;  ///< map frame
};

/// What distances count for a body; metres from its surface.
struct SphereReach {
  double near = 0.0;   ///< spheres that are farther from blocked space are left out
  double close = 0.0;  ///< nearer ones are marked
};

/// Which cover spheres of some bodies may be within reach of blocked space, for loops: bodies as a whole from
/// one cell of the distance field, then their spheres from one cell each, then closely. It allocates nothing
/// after the last `add`.
class BroadPhase {
 public:
  /// @param space must live as long.
  explicit BroadPhase(const BlockedSpace& space) : space_(space) {}

  /// @param bound holds the body, its cover holds the body; link frame.
  void add(int link, const Sphere& bound, std::span<const Sphere> cover);

  /// @param reach of each body, as they were added
  /// @return in the order in which bodies and spheres were added; valid until the next call
  std::span<const NearSphere> look(const LinkPoses& map_from_link, std::span<const SphereReach> reach);

  std::size_t size() const { return spheres_.size(); }  ///< of all spheres

 private:
  struct Cover {
    int link;
    Sphere bound;
    int first, last;  ///< of spheres_
  };
  struct CoverSphere {
    Sphere shape;
    int body;
  };
  void put(std::size_t at, const Eigen::Isometry3d& pose, const Eigen::Vector3d& point);
  void look_up(std::size_t count, bool closely);
  std::size_t keep_near(std::size_t count, std::span<const SphereReach> reach);

  const BlockedSpace& space_;
  std::vector<Cover> covers_;
  std::vector<CoverSphere> spheres_;
  std::vector<int> sphere_of_;                 ///< of the points that are looked up
  std::vector<double> x_, y_, z_, clearance_;  ///< of these, filled up to whole registers
  std::vector<NearSphere> near_;
};

}  // namespace clearway
