// Rays against the bits of a BlockedField: OctoMap's castRay, step for step, without a search of the tree at
// each.

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstdint>
#include <limits>
#include <stdexcept>

#include "mapping/field/blocked_field.hpp"

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

  /// Goes on by at most `steps`, until it stands in a cell of which `stops(x, y, z)` is true.
  template <class Stops>
  void advance(int steps, const Stops& stops) {
    Axis x = axis(0), y = axis(1), z = axis(2);
    for (; steps > 0; --steps) {
      const Choice x_before_y = less(x.next, y.next);
      const Choice on_x = x_before_y & less(x.next, z.next);
      const Choice on_y = ~x_before_y & less(y.next, z.next);
      go(x, on_x);
      go(y, on_y);
      go(z, ~(on_x | on_y));
      if (stops(static_cast<int>(x.cell), static_cast<int>(y.cell), static_cast<int>(z.cell))) break;
    }
    next_ = {x.next, y.next, z.next};
    cell_ = {static_cast<int>(x.cell), static_cast<int>(y.cell), static_cast<int>(z.cell)};
  }

 private:
  // All bits or none, so that a step has no branch to guess wrong.
  using Choice = std::int64_t;
  struct Axis {
    double next;
    std::int64_t delta, cell, step;  ///< delta: the bits of a double
  };
  Axis axis(int i) const {
    const auto at = static_cast<std::size_t>(i);
    return {next_[at], std::bit_cast<std::int64_t>(delta_[at]), cell_[i], step_[i]};
  }
  static Choice less(double a, double b) { return -static_cast<std::int64_t>(a < b); }
  static void go(Axis& axis, Choice chosen) {
    axis.next += std::bit_cast<double>(axis.delta & chosen);  // adding 0.0 changes nothing
    axis.cell += axis.step & chosen;
  }

  static constexpr double never = std::numeric_limits<double>::max();
  Eigen::Vector3f origin_;
  Eigen::Vector3i cell_ = Eigen::Vector3i::Zero(), step_ = Eigen::Vector3i::Zero();
  std::array<double, 3> next_{never, never, never}, delta_{never, never, never};
};

/// How many voxels off the map's origin a ray may start.
constexpr double most_cells_away = 268435456.0;

/// A walk looks at its range after so many steps at most.
constexpr int steps_at_once = 32;

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
  // Beyond these the rounding to float gives infinity, and cells are no ints any more.
  const bool is_far = !(origin.cwiseAbs().maxCoeff() < most_cells_away * cells_.resolution);
  const float squared = direction.cast<float>().squaredNorm();
  if (!origin.allFinite() || !direction.allFinite() || !(max_range >= 0.0) || is_far ||
      !std::isfinite(squared)) {
    throw std::invalid_argument(
        "ray: expected a finite origin within 268 million voxels, a finite direction no longer than 1e19 and "
        "a "
        "range >= 0 in metres");
  }
  CellWalk walk(origin, direction, cells_.resolution);
  if (walk.step().isZero()) throw std::invalid_argument("ray: expected a direction that is not zero");
  const Eigen::Vector3f start = origin.cast<float>();
  const double limit = max_range > 0.0 ? max_range * max_range : std::numeric_limits<double>::infinity();
  const auto end_at = [&](const Eigen::Vector3i& cell, bool hit) {
    const Eigen::Vector3d voxel = center(cell);
    return RayHit{hit, voxel, std::sqrt(squared_range(start, voxel.cast<float>()))};
  };
  // Bits, not the field: they stay in the cache, and a distance would have to be fetched from memory.
  const BlockedCells& blocked = tiles_->blocked();
  const Eigen::Vector3i origin_cell = cells_.first;
  const auto is_stop = [&](int x, int y, int z) {
    return blocked.at(x - origin_cell.x(), y - origin_cell.y(), z - origin_cell.z());
  };
  for (bool first = true;; first = false) {
    const Eigen::Vector3i cell = walk.cell();
    if (!first && squared_range(start, center(cell).cast<float>()) > limit) return end_at(cell, false);
    if (cells_.contains(cell)) {
      if (is_stop(cell.x(), cell.y(), cell.z())) return end_at(cell, true);
      const int inside = steps_to_border(cells_, cell, walk.step()) - 1;
      if (inside > 0) {
        walk.advance(std::min(inside, steps_at_once), is_stop);
      } else {
        walk.advance(1, [](int, int, int) { return true; });
      }
      continue;
    }
    if (outside_blocked_) return end_at(cell, true);
    const Eigen::Array3i ahead = walk.step().array();
    const Eigen::Array3i from_first = (cell - cells_.first).array();
    const bool leaves =
        ((from_first >= cells_.size.array() && ahead >= 0) || (from_first < 0 && ahead <= 0)).any();
    if (leaves) return end_at(cell, false);
    walk.advance(1, [](int, int, int) { return true; });
  }
}

}  // namespace clearway
