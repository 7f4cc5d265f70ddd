// Rays against a BlockedField: OctoMap's castRay, step for step, without a search of the tree at each.

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <stdexcept>

#include "mapping/blocked_field.hpp"

namespace clearway {
namespace {

/// The traversal of Amanatides and Woo 1987 with OctoMap's own arithmetic, so that both meet the same voxels
/// to the last bit: origin and direction are rounded to float, voxel centres are doubles.
class CellWalk {
 public:
  CellWalk(const Eigen::Vector3d& origin, const Eigen::Vector3d& direction, double resolution)
      : origin_(origin.cast<float>()) {
    const Eigen::Vector3f towards = direction.cast<float>();
    const float x = towards.x(), y = towards.y(), z = towards.z();
    const float length = static_cast<float>(std::sqrt(static_cast<double>(x * x + y * y + z * z)));
    const double inverse = 1.0 / resolution;
    for (int axis = 0; axis < 3; ++axis) {
      const float unit = length > 0.0F ? towards[axis] / length : 0.0F;
      const double at = origin_[axis];
      cell_[axis] = static_cast<int>(std::floor(inverse * at));
      if (unit == 0.0F) continue;
      step_[axis] = unit > 0.0F ? 1 : -1;
      const double center = (static_cast<double>(cell_[axis]) + 0.5) * resolution;
      next_[axis] = (center + step_[axis] * resolution * 0.5 - at) / static_cast<double>(unit);
      delta_[axis] = resolution / std::abs(static_cast<double>(unit));
    }
  }

  const Eigen::Vector3i& cell() const { return cell_; }
  const Eigen::Vector3i& step() const { return step_; }

  void advance(int steps) {
    double nx = next_[0], ny = next_[1], nz = next_[2];
    int x = cell_.x(), y = cell_.y(), z = cell_.z();
    for (; steps > 0; --steps) {
      const bool xy = nx < ny, xz = nx < nz, yz = ny < nz;
      const bool on_x = xy && xz, on_y = !xy && yz, on_z = !on_x && !on_y;
      x += on_x ? step_.x() : 0;
      y += on_y ? step_.y() : 0;
      z += on_z ? step_.z() : 0;
      nx = on_x ? nx + delta_[0] : nx;
      ny = on_y ? ny + delta_[1] : ny;
      nz = on_z ? nz + delta_[2] : nz;
    }
    next_ = {nx, ny, nz};
    cell_ = {x, y, z};
  }

 private:
  static constexpr double never = std::numeric_limits<double>::max();
  Eigen::Vector3f origin_;
  Eigen::Vector3i cell_ = Eigen::Vector3i::Zero(), step_ = Eigen::Vector3i::Zero();
  std::array<double, 3> next_{never, never, never}, delta_{never, never, never};
};

/// Steps after which a walk can at the earliest stand in a blocked cell. `gap` is the squared distance, in
/// half voxels, from its cell's centre to the nearest blocked cube; the cube that a walk reaches in n steps
/// is at most 2n - 1 away.
int steps_to_blocked(std::uint16_t gap) {
  return static_cast<int>(std::ceil((std::sqrt(static_cast<float>(gap)) + 1.0F) * 0.5F));
}

/// Steps after which a walk from `cell` can at the earliest stand outside the region.
int steps_to_border(const FieldRegion& cells, const Eigen::Vector3i& cell, const Eigen::Vector3i& step) {
  int steps = std::numeric_limits<int>::max();
  for (int axis = 0; axis < 3; ++axis) {
    const int from_first = cell[axis] - cells.first[axis];
    if (step[axis] > 0) steps = std::min(steps, cells.size[axis] - from_first);
    if (step[axis] < 0) steps = std::min(steps, from_first + 1);
  }
  return steps;
}

/// The squared distance as OctoMap compares it with the squared range: squares in float, their sum in double.
double squared_range(const Eigen::Vector3f& from, const Eigen::Vector3f& to) {
  double sum = 0.0;
  for (int axis = 0; axis < 3; ++axis) {
    const float square = (to[axis] - from[axis]) * (to[axis] - from[axis]);
    sum += static_cast<double>(square);
  }
  return sum;
}

}  // namespace

RayHit BlockedField::cast_ray(const Eigen::Vector3d& origin, const Eigen::Vector3d& direction,
                              double max_range) const {
  if (!origin.allFinite() || !direction.allFinite() || !(max_range >= 0.0)) {
    throw std::invalid_argument("ray: expected a finite origin and direction and a range >= 0 in metres");
  }
  CellWalk walk(origin, direction, cells_.resolution);
  if (walk.step().isZero()) throw std::invalid_argument("ray: expected a direction that is not zero");
  const Eigen::Vector3f start = origin.cast<float>();
  RayHit result;
  for (bool first = true;; first = false) {
    const Eigen::Vector3i cell = walk.cell();
    result.voxel = center(cell);
    const double range = squared_range(start, result.voxel.cast<float>());
    result.distance = std::sqrt(range);
    if (max_range > 0.0 && range > max_range * max_range && !first) return result;
    const bool inside = cells_.contains(cell);
    const std::uint16_t gap = inside ? squared(cell) : std::uint16_t{0};
    result.hit = inside ? gap == 0 : outside_blocked_;
    if (result.hit) return result;
    if (inside) {
      walk.advance(std::min(steps_to_blocked(gap), steps_to_border(cells_, cell, walk.step())));
      continue;
    }
    const Eigen::Array3i ahead = walk.step().array();
    const Eigen::Array3i from_first = (cell - cells_.first).array();
    const bool leaves =
        ((from_first >= cells_.size.array() && ahead >= 0) || (from_first < 0 && ahead <= 0)).any();
    if (leaves) return result;
    walk.advance(1);
  }
}

}  // namespace clearway
