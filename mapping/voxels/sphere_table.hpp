#pragma once

#include <algorithm>
#include <array>
#include <bit>
#include <cstddef>
#include <vector>

#include "mapping/voxels/fused_tree.hpp"

namespace clearway {

/// Which cubes of cells a sphere covers, to the last bit as the definition says, from a table: for each axis
/// and cell the squared distance from the sphere's centre to the cell's far side. A voxel lies wholly inside
/// the closed sphere when the three add up to r^2 at most.
class SphereTable {
 public:
  SphereTable(const Sphere& sphere, double resolution);

  /// What the sphere covers of the eight children of a cube.
  struct Children {
    unsigned all = 0;   ///< bit i: all of child i
    unsigned some = 0;  ///< bit i: at least one voxel of child i
  };
  /// Precondition: at least one voxel of the cube lies wholly inside the sphere.
  Children children(const CellCube& cube) const {
    const int level = std::countr_zero(static_cast<unsigned>(cube.edge)) - 1;
    const std::array<int, 3>& start = levels_[static_cast<std::size_t>(level)];
    std::array<std::size_t, 3> row{};
    for (std::size_t axis = 0; axis < 3; ++axis) {
      row[axis] = static_cast<std::size_t>(((cube.corner[static_cast<int>(axis)] + lowest_cell) >> level) +
                                           start[axis]);
    }
    const unsigned some = within_reach(nearest_, row);
    return {level == 0 ? some : within_reach(farthest_, row), some};
  }

  /// True when all of the cube lies inside the sphere.
  bool covers(const CellCube& cube) const;
  /// True when at least one voxel of the cube lies wholly inside the sphere: the one with the nearest
  /// farthest corner is, axis by axis, the one whose centre is nearest.
  bool covers_some_voxel(const CellCube& cube) const;

  /// Voxels that lie wholly inside the sphere, of those that a tree can hold.
  std::size_t count() const;

 private:
  double far_side(int axis, int cell) const {
    const auto a = static_cast<std::size_t>(axis);
    return table_[static_cast<std::size_t>(std::clamp(cell, first_[a], last_[a]) + offset_[a])];
  }

  static constexpr int lowest_cell = 32768;  ///< the tree's cells start at minus this
  double radius_squared_;
  double cells_per_metre_;
  double middle_ = 0.0;                  ///< x of the sphere's centre in cells, from the table's first
  std::array<int, 3> center_{};          ///< cell of the sphere's centre, or the nearest to it
  std::array<int, 3> first_{}, last_{};  ///< cells in the table; either end stands for all beyond: infinity
  std::array<int, 3> offset_{};          ///< from a cell to its place in the table
  std::vector<double> table_;

  /// Bit i: the sum of the squared distances of child i is r^2 at most. Two children at a time.
  unsigned within_reach(const std::vector<double>& squared, const std::array<std::size_t, 3>& row) const {
    using Pair = double __attribute__((vector_size(16)));
    using Bits = long long __attribute__((vector_size(16)));
    const Pair x{squared[row[0]], squared[row[0] + 1]};
    const Pair limit{radius_squared_, radius_squared_};
    Bits result{0, 0};
#pragma GCC unroll 4
    for (unsigned i = 0; i < 4; ++i) {
      const double y = squared[row[1] + (i & 1U)], z = squared[row[2] + (i >> 1U)];
      const Bits bits{1LL << 2U * i, 2LL << 2U * i};
      result |= (x + y + z <= limit) & bits;
    }
    return static_cast<unsigned>(result[0] | result[1]);
  }
  void add_level(int level);

  std::array<std::array<int, 3>, 16>
      levels_{};  ///< from a row's number, counted from the lowest cell, to its place
  std::vector<double> nearest_, farthest_;  ///< least and largest of `table_` in a row of 2^level cells
};

}  // namespace clearway
