#pragma once

#include <Eigen/Core>
#include <cstdint>

namespace clearway {

/// A voxel as one number, for tables: its three indices side by side, each within 2^20 of the origin. Keys
/// add up as indices do: voxel_key(a + b) == voxel_key(a) + voxel_step(b).
using VoxelKey = std::uint64_t;
constexpr VoxelKey no_voxel = 0;  ///< what would be (-2^20, -2^20, -2^20)

constexpr int voxel_key_bias = 1 << 20;

constexpr VoxelKey voxel_step(int x, int y, int z) {
  const auto part = [](int index) { return static_cast<VoxelKey>(static_cast<std::int64_t>(index)); };
  return (part(x) << 42U) + (part(y) << 21U) + part(z);
}

inline VoxelKey voxel_key(const Eigen::Vector3i& voxel) {
  return voxel_step(voxel.x() + voxel_key_bias, voxel.y() + voxel_key_bias, voxel.z() + voxel_key_bias);
}

inline Eigen::Vector3i voxel_of(VoxelKey key) {
  constexpr VoxelKey mask = (VoxelKey{1} << 21U) - 1U;
  const auto index = [](VoxelKey part) { return static_cast<int>(part & mask) - voxel_key_bias; };
  return {index(key >> 42U), index(key >> 21U), index(key)};
}

/// The largest whole number that is not above `value`; |value| < 2^31.
inline int whole_below(double value) {
  const int whole = static_cast<int>(value);
  return whole - (value < whole ? 1 : 0);
}

}  // namespace clearway
