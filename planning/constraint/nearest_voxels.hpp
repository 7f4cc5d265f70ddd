#pragma once

#include <Eigen/Core>
#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "mapping/field/blocked_space.hpp"
#include "planning/constraint/voxel_key.hpp"

namespace clearway {

/// The blocked cubes nearest to the middles of voxels, for loops that ask again close by: what was found is
/// remembered by voxel (16384 of them), and new ones are derived from the distance field alone. On
/// either side of a voxel whose nearest cube lies k voxels away along an axis, the squared distance is one
/// that gives k; the candidates so found are proved by being blocked and exactly as far as the field says.
/// Where none passes (between obstacles), those that the neighbours see are tried; at last
/// BlockedSpace::nearest searches.
class NearestVoxels {
 public:
  /// @param space must live as long.
  explicit NearestVoxels(const BlockedSpace& space);

  /// out[i] is that of voxels[i], floor(point / resolution); no_voxel: none within the field's max_distance.
  void look_up(std::span<const VoxelKey> voxels, std::span<VoxelKey> out);

  std::size_t looked_up() const { return looked_up_; }  ///< that were not remembered
  std::size_t searched() const { return searched_; }    ///< of these, by BlockedSpace::nearest

 private:
  struct Place {
    VoxelKey voxel = no_voxel, cube = no_voxel;
  };
  /// Voxels from one to its nearest cube; `nothing` in x: none that is known.
  using Offset = std::array<std::int8_t, 4>;
  static constexpr std::int8_t nothing = 127;
  using Squares = std::array<int, 7>;
  Offset offset_by_field(const Eigen::Vector3i& voxel, const Squares& squared, int depth);
  bool by_differences(const Eigen::Vector3i& voxel, const Squares& squared, Offset& offset) const;
  bool by_neighbours(const Eigen::Vector3i& voxel, const Squares& squared, int depth, Offset& offset);

  const BlockedSpace& space_;
  double resolution_;
  int beyond_;  ///< squared distances that are no smaller are beyond the field's max_distance
  std::vector<Place> places_;
  std::vector<std::size_t> missing_;  ///< of the voxels under way
  std::vector<Squares> squares_;      ///< about these
  std::size_t looked_up_ = 0, searched_ = 0;
};

}  // namespace clearway
