// Volume of a union of spheres between proved bounds: adaptive cubes, planes for those that the surface cuts.

#include <algorithm>
#include <cmath>
#include <queue>
#include <stdexcept>

#include "mapping/volumes/sphere_union.hpp"

namespace clearway {
namespace {

const double sqrt3 = std::sqrt(3.0);

/// Volume of { |x_i| <= half, normal . x <= offset }. Precondition: no component of the unit normal is tiny.
double cut_cube_volume(const Eigen::Vector3d& normal, double offset, double half) {
  const Eigen::Array3d n = normal.array().abs();
  const double reach = half * n.sum();
  if (offset >= reach) return 8.0 * half * half * half;
  if (offset <= -reach) return 0.0;
  double sum = 0.0;
  for (unsigned corner = 0; corner < 8; ++corner) {
    double level = offset + reach;
    int sign = 1;
    for (int axis = 0; axis < 3; ++axis) {
      if ((corner >> axis & 1U) == 0) continue;
      level -= 2.0 * half * n[axis];
      sign = -sign;
    }
    if (level > 0.0) sum += sign * level * level * level;
  }
  return std::clamp(sum / (6.0 * n.prod()), 0.0, 8.0 * half * half * half);
}

/// A direction near `wanted` none of whose components is tiny: the planes below may have any direction.
Eigen::Vector3d steady_direction(const Eigen::Vector3d& wanted) {
  Eigen::Vector3d n = wanted.norm() > 0.0 ? Eigen::Vector3d(wanted.normalized()) : Eigen::Vector3d::Ones();
  for (int axis = 0; axis < 3; ++axis) n[axis] = std::copysign(std::max(std::abs(n[axis]), 1e-3), n[axis]);
  return n.normalized();
}

class Cubes {
 public:
  Cubes(const std::vector<Sphere>& spheres, double relative_width)
      : spheres_(spheres), width_(relative_width) {}

  VolumeBounds measure(std::size_t most_cells) {
    start();
    while (!open_.empty() && open_gap_ > width_ * (full_ + settled_upper_ + open_upper_) &&
           cells_ < most_cells) {
      const Cell cell = open_.top();
      open_.pop();
      open_gap_ -= cell.gap();
      open_upper_ -= cell.upper;
      split(cell);
    }
    // Sums afresh: the running ones have gathered rounding.
    VolumeBounds bounds{full_ + settled_lower_, full_ + settled_upper_};
    for (; !open_.empty(); open_.pop()) {
      bounds.lower += open_.top().lower;
      bounds.upper += open_.top().upper;
    }
    constexpr double rounding = 1e-9;
    return {bounds.lower * (1.0 - rounding), bounds.upper * (1.0 + rounding)};
  }

 private:
  /// A cube that the surface may cut; its spheres are a stretch of `lists_`.
  struct Cell {
    Eigen::Vector3d center = Eigen::Vector3d::Zero();
    double half = 0.0;
    double lower = 0.0, upper = 0.0;
    std::size_t first = 0, count = 0;
    std::size_t number = 0;

    double gap() const { return upper - lower; }
    bool operator<(const Cell& other) const {
      return gap() != other.gap() ? gap() < other.gap() : number > other.number;
    }
  };

  void start() {
    Eigen::Array3d low = Eigen::Array3d::Constant(HUGE_VAL), high = -low;
    for (const Sphere& sphere : spheres_) {
      low = low.min(sphere.center.array() - sphere.radius);
      high = high.max(sphere.center.array() + sphere.radius);
      lists_.push_back(static_cast<unsigned>(lists_.size()));
    }
    Cell root;
    root.center = 0.5 * (low + high);
    root.half = 0.5 * (high - low).maxCoeff();
    root.count = lists_.size();
    add(root);
  }

  void split(const Cell& cell) {
    for (unsigned i = 0; i < 8; ++i) {
      Cell part = cell;
      part.half = 0.5 * cell.half;
      for (int axis = 0; axis < 3; ++axis)
        part.center[axis] += (i >> axis & 1U) != 0 ? part.half : -part.half;
      add(part);
    }
  }

  /// Settles the cell when it is full or empty; else bounds what is covered and keeps it for splitting.
  void add(Cell& cell) {
    ++cells_;
    const std::size_t begin = lists_.size();
    for (std::size_t k = 0; k < cell.count; ++k) {
      const unsigned index = lists_[cell.first + k];
      const Sphere& sphere = spheres_[index];
      const Eigen::Array3d away = (sphere.center - cell.center).array().abs();
      const double squared = sphere.radius * sphere.radius;
      if ((away - cell.half).max(0.0).square().sum() >= squared) continue;
      if ((away + cell.half).square().sum() <= squared) {
        full_ += 8.0 * cell.half * cell.half * cell.half;
        lists_.resize(begin);
        return;
      }
      lists_.push_back(index);
    }
    const std::size_t count = lists_.size() - begin;
    if (count == 0) return;
    if (count == cell.count) {
      lists_.resize(begin);  // nothing dropped: the parent's list serves
    } else {
      cell.first = begin;
      cell.count = count;
    }
    bound(cell);
    cell.number = cells_;
    if (cell.gap() <= 0.0) {
      settled_lower_ += cell.lower;
      settled_upper_ += cell.upper;
      return;
    }
    open_gap_ += cell.gap();
    open_upper_ += cell.upper;
    open_.push(cell);
  }

  /// With n from the sphere that reaches deepest, a cube's points are center + s n + t, |t| <= w, n.t = 0, w
  /// its half diagonal. A sphere at center + o n + q (n.q = 0) holds all points of the cube with s <= o +
  /// sqrt(r^2 - (|q| + w)^2) and none with s > o + sqrt(r^2 - max(|q| - w, 0)^2).
  void bound(Cell& cell) const {
    const unsigned* list = lists_.data() + cell.first;
    const double w = sqrt3 * cell.half;
    double deepest = -HUGE_VAL;
    Eigen::Vector3d towards = Eigen::Vector3d::Zero();
    for (std::size_t k = 0; k < cell.count; ++k) {
      const Sphere& sphere = spheres_[list[k]];
      const double depth = sphere.radius - (cell.center - sphere.center).norm();
      if (depth <= deepest) continue;
      deepest = depth;
      towards = cell.center - sphere.center;
    }
    const Eigen::Vector3d n = steady_direction(towards);
    double inner = -HUGE_VAL, outer = -HUGE_VAL;
    for (std::size_t k = 0; k < cell.count; ++k) {
      const Sphere& sphere = spheres_[list[k]];
      const Eigen::Vector3d offset = sphere.center - cell.center;
      const double along = offset.dot(n);
      const double across = (offset - along * n).norm();
      const double squared = sphere.radius * sphere.radius;
      const double near = std::max(across - w, 0.0), far = across + w;
      if (near < sphere.radius) outer = std::max(outer, along + std::sqrt(squared - near * near));
      if (far >= sphere.radius) continue;
      const double chord = std::sqrt(squared - far * far);
      if (along - chord <= -w) inner = std::max(inner, along + chord);
    }
    cell.lower = cut_cube_volume(n, inner, cell.half);
    cell.upper = cut_cube_volume(n, outer, cell.half);
  }

  const std::vector<Sphere>& spheres_;
  double width_;
  std::priority_queue<Cell> open_;
  std::vector<unsigned> lists_;
  double full_ = 0.0, settled_lower_ = 0.0, settled_upper_ = 0.0;
  double open_gap_ = 0.0, open_upper_ = 0.0;
  std::size_t cells_ = 0;
};

}  // namespace

VolumeBounds union_volume(const std::vector<Sphere>& spheres, double relative_width, std::size_t most_cells) {
  for (const Sphere& sphere : spheres) {
    if (!sphere.center.allFinite() || !std::isfinite(sphere.radius) || !(sphere.radius > 0.0)) {
      throw std::invalid_argument("volume of balls: expected finite centres and radii > 0 in metres");
    }
  }
  if (!(relative_width > 0.0 && relative_width < 1.0)) {
    throw std::invalid_argument("volume of balls: relative_width is " + std::to_string(relative_width) +
                                ", expected a value in (0, 1)");
  }
  if (spheres.empty()) return {};
  return Cubes(spheres, relative_width).measure(most_cells);
}

}  // namespace clearway
