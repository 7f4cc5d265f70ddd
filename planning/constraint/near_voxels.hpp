#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <cstdint>
#include <span>
#include <vector>

#include "planning/constraint/broad_phase.hpp"
#include "planning/constraint/nearest_voxels.hpp"
#include "planning/geometry/voxel_distance.hpp"

namespace clearway {

/// The cubes that the spheres of a body see: the one nearest to a sphere's voxel; of a sphere that is close
/// those nearest to the eight voxels about its middle and to the six that lie three away along the map's
/// axes, too. Cubes that the body cannot reach do not count; where these, or the field's end, hide what may
/// be near, cubes are visited one by one.
class NearVoxels {
 public:
  /// @param space must live as long.
  explicit NearVoxels(const BlockedSpace& space);

  /// A body whose number of spheres is given; voxels beyond `reach_box` do not count for it.
  void add(const Eigen::AlignedBox3d& reach_box, std::size_t spheres);

  /// Looks all spheres up at once.
  void look(std::span<const NearSphere> spheres);

  /// The cubes of spheres first to last, which belong to one body: each once, as the sphere has it that it is
  /// least behind of. Valid until the next call. @pre the spheres are those of the last look.
  std::span<const NearVoxel> gather(std::span<const NearSphere> spheres, std::size_t first, std::size_t last);

 private:
  struct Reach {
    Eigen::AlignedBox3d box;
    Eigen::Vector3i low, high;  ///< voxels whose cubes meet it
    bool holds(const Eigen::Vector3i& voxel) const {
      bool inside = true;
      for (int axis = 0; axis < 3; ++axis) inside &= voxel[axis] >= low[axis] && voxel[axis] <= high[axis];
      return inside;
    }
  };
  /// What is known of a cube while a body's are gathered.
  struct Known {
    VoxelKey key = no_voxel;
    std::uint32_t turn = 0;   ///< of gathering: of an older one, it is free
    std::int32_t sphere = 0;  ///< that saw it last
    std::int32_t place = -1;  ///< in gathered_
    bool is_in_reach = false;
    Eigen::Vector3d center;  ///< map frame
  };
  void gather(const NearSphere& sphere, int which, std::span<const VoxelKey> cubes);
  void visit(const NearSphere& sphere, double within);
  Known& known(VoxelKey key, const Reach& reach);
  void make_room(std::size_t more);
  void add_cube(Known& known, const NearSphere& sphere, double behind);
  Eigen::Vector3d center_of(const Eigen::Vector3i& voxel) const {
    return (voxel.cast<double>().array() + 0.5) * resolution_;
  }

  /// No voxel of a map has larger coordinates, and keys hold them.
  double farthest() const { return (voxel_key_bias - 8) * resolution_; }

  const BlockedSpace& space_;
  NearestVoxels nearest_;
  double resolution_;
  std::vector<Reach> reaches_;            ///< of each body
  std::vector<VoxelKey> voxels_, cubes_;  ///< that are looked up
  std::vector<std::size_t> first_;        ///< of the voxels of each sphere, and the end
  std::vector<Eigen::Vector3d> visited_;
  std::vector<NearVoxel> gathered_;
  std::vector<Known> known_;  ///< by a hash of the key; a power of two, no more than half of it in use
  std::uint32_t turn_ = 0;
  std::size_t known_count_ = 0;
  std::size_t most_spheres_ = 0;
};

}  // namespace clearway
