#include "mapping/voxels/sphere_table.hpp"

#include <cmath>

namespace clearway {
namespace {

/// A cell number kept within the tree's cells and one more on either side.
int to_cell(double cell) { return static_cast<int>(std::clamp(cell, -32769.0, 32768.0)); }

}  // namespace

SphereTable::SphereTable(const Sphere& sphere, double resolution)
    : radius_squared_(sphere.radius * sphere.radius), cells_per_metre_(1.0 / resolution) {
  for (std::size_t axis = 0; axis < 3; ++axis) {
    const double at = sphere.center[static_cast<int>(axis)];
    center_[axis] = to_cell(std::floor(at / resolution));
    // Two cells more than the sphere spans: beyond them rounding cannot matter.
    first_[axis] = to_cell(std::floor((at - sphere.radius) / resolution) - 2.0);
    last_[axis] = to_cell(std::floor((at + sphere.radius) / resolution) + 2.0);
    offset_[axis] = static_cast<int>(table_.size()) - first_[axis];
    table_.push_back(HUGE_VAL);
    double low = std::abs((first_[axis] + 1) * resolution - at);
    for (int cell = first_[axis] + 1; cell < last_[axis]; ++cell) {
      const double high = std::abs((cell + 1) * resolution - at);
      const double far = std::max(low, high);
      table_.push_back(far * far);
      low = high;
    }
    table_.push_back(HUGE_VAL);
  }
  middle_ = sphere.center.x() / resolution - first_[0];
  nearest_.reserve(2 * table_.size() + 150);
  farthest_.reserve(2 * table_.size() + 150);
  for (int level = 0; level < 16; ++level) add_level(level);
}

/// Whole pairs of rows: the halves of every cube that the sphere reaches.
void SphereTable::add_level(int level) {
  for (std::size_t axis = 0; axis < 3; ++axis) {
    const int begin = 2 * ((first_[axis] + lowest_cell) >> (level + 1));
    const int end = 2 * ((last_[axis] + lowest_cell) >> (level + 1)) + 2;
    levels_[static_cast<std::size_t>(level)][axis] = static_cast<int>(nearest_.size()) - begin;
    for (int row = begin; row < end; ++row) {
      const int low = row * (1 << level) - lowest_cell, high = low + (1 << level) - 1;
      const int a = static_cast<int>(axis);
      nearest_.push_back(far_side(a, std::clamp(center_[axis], low, high)));
      farthest_.push_back(std::max(far_side(a, low), far_side(a, high)));
    }
  }
}

bool SphereTable::covers(const CellCube& cube) const {
  double sum = 0.0;
  for (int axis = 0; axis < 3; ++axis) {
    const int low = cube.corner[axis], high = low + cube.edge - 1;
    sum += std::max(far_side(axis, low), far_side(axis, high));
  }
  return sum <= radius_squared_;
}

bool SphereTable::covers_some_voxel(const CellCube& cube) const {
  double sum = 0.0;
  for (int axis = 0; axis < 3; ++axis) {
    const int low = cube.corner[axis], high = low + cube.edge - 1;
    sum += far_side(axis, std::clamp(center_[static_cast<std::size_t>(axis)], low, high));
  }
  return sum <= radius_squared_;
}

/// Row by row. Pythagoras guesses where the covered cells of a row begin and end; the table decides.
std::size_t SphereTable::count() const {
  if (covers(CellCube{})) return CellCube{}.volume();
  const int end = last_[0] - first_[0];  // cells of the table lie between 0 and `end`, which no sphere covers
  if (end < 2) return 0;
  const int nearest = std::clamp(center_[0] - first_[0], 1, end - 1);
  const double* const far_x = table_.data();
  std::size_t sum = 0;
  for (int z = first_[2] + 1; z < last_[2]; ++z) {
    const double far_z = far_side(2, z);
    for (int y = first_[1] + 1; y < last_[1]; ++y) {
      const double far_y = far_side(1, y);
      const auto inside = [&](int x) { return far_x[x] + far_y + far_z <= radius_squared_; };
      if (!inside(nearest)) continue;
      const double half = std::sqrt(std::max(radius_squared_ - far_y - far_z, 0.0)) * cells_per_metre_;
      int low = static_cast<int>(std::clamp(middle_ - half, 0.0, end - 2.0)) + 1;
      int high = static_cast<int>(std::clamp(middle_ + half, 2.0, static_cast<double>(end)));
      if (!inside(low) || inside(low - 1) || !inside(high - 1) || inside(high)) {
        for (low = nearest; inside(low - 1);) --low;
        for (high = nearest; inside(high);) ++high;
      }
      sum += static_cast<std::size_t>(high - low);
    }
  }
  return sum;
}

}  // namespace clearway
