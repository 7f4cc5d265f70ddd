#pragma once

#include <Eigen/Geometry>
#include <array>
#include <cstdint>

#include "mapping/scans/ray_cast.hpp"

namespace clearway {

/// Sixteen points of a scan in the map frame, with their cells.
struct PointBatch {
  static constexpr std::size_t size = 16;
  static constexpr double lowest_cell = -32768.0, highest_cell = 32767.0;  ///< of the tree
  alignas(64) std::array<float, size> x, y, z;
  alignas(64) std::array<std::int32_t, size> cell_x, cell_y, cell_z;  ///< of those that have a cell
  unsigned finite = 0;    ///< bit i: point i is finite (no infinity, no NaN)
  unsigned has_cell = 0;  ///< bit i: and lies within the tree

  Eigen::Vector3f point(std::size_t i) const { return {x[i], y[i], z[i]}; }
  Eigen::Vector3i cell(std::size_t i) const { return {cell_x[i], cell_y[i], cell_z[i]}; }
};

/// Transforms `count` <= 16 points and finds their cells: bit for bit what `map_from_sensor *
/// point.cast<double>()`, rounded to float, and FusedTree::cell give, with any instruction set.
/// @param factor voxels per metre, octomap's resolution_factor: 1.0 / resolution.
void place_points(const Eigen::Vector3f* points, std::size_t count, const Eigen::Isometry3d& map_from_sensor,
                  double factor, InstructionSet set, PointBatch& batch);

}  // namespace clearway
