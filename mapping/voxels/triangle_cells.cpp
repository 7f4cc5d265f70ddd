#include "mapping/voxels/triangle_cells.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>

namespace clearway {
namespace {

constexpr double farthest_cell = 1e9;

/// Halves the block of cells `first` to `last` along its longest side, as long as the triangle meets it.
void visit_block(const Triangle& triangle, double edge, const Eigen::Vector3i& first,
                 const Eigen::Vector3i& last, const std::function<void(const Eigen::Vector3i&)>& visit) {
  const Eigen::Array3d cells = (last - first).array().cast<double>() + 1.0;
  const Eigen::Vector3d half = 0.5 * edge * cells;
  if (!triangle_meets_box(triangle, edge * (first.cast<double>().array() + 0.5 * cells), half)) return;
  if (first == last) return visit(first);
  int axis = 0;
  (last - first).maxCoeff(&axis);
  Eigen::Vector3i before = last, after = first;
  before[axis] = first[axis] + (last[axis] - first[axis]) / 2;
  after[axis] = before[axis] + 1;
  visit_block(triangle, edge, first, before, visit);
  visit_block(triangle, edge, after, last, visit);
}

}  // namespace

bool triangle_meets_box(const Triangle& triangle, const Eigen::Vector3d& center,
                        const Eigen::Vector3d& half) {
  const Eigen::Vector3d corners[] = {triangle[0] - center, triangle[1] - center, triangle[2] - center};
  const auto is_apart = [&](const Eigen::Vector3d& axis) {
    const double length = axis.lpNorm<1>();
    if (length == 0.0) return false;
    double low = HUGE_VAL, high = -HUGE_VAL, size = half.maxCoeff();
    for (const Eigen::Vector3d& corner : corners) {
      const double at = axis.dot(corner);
      low = std::min(low, at);
      high = std::max(high, at);
      size = std::max(size, corner.lpNorm<Eigen::Infinity>());
    }
    const double reach = half.dot(axis.cwiseAbs()) + 1e-10 * size * length;
    return low > reach || high < -reach;
  };
  const Eigen::Vector3d sides[] = {triangle[1] - triangle[0], triangle[2] - triangle[1],
                                   triangle[0] - triangle[2]};
  if (is_apart(sides[0].cross(sides[1]))) return false;
  for (int i = 0; i < 3; ++i) {
    const Eigen::Vector3d axis = Eigen::Vector3d::Unit(i);
    if (is_apart(axis)) return false;
    for (const Eigen::Vector3d& side : sides)
      if (is_apart(axis.cross(side))) return false;
  }
  return true;
}

void visit_cells_met(const Triangle& triangle, double edge,
                     const std::function<void(const Eigen::Vector3i&)>& visit) {
  const Eigen::Vector3d low = triangle[0].cwiseMin(triangle[1]).cwiseMin(triangle[2]);
  const Eigen::Vector3d high = triangle[0].cwiseMax(triangle[1]).cwiseMax(triangle[2]);
  const auto cell = [&](const Eigen::Vector3d& point, double aside) {
    return Eigen::Vector3i(
        (point.array() / edge + aside).floor().max(-farthest_cell).min(farthest_cell).cast<int>());
  };
  visit_block(triangle, edge, cell(low, -1e-6), cell(high, 1e-6), visit);
}

}  // namespace clearway
