#pragma once

#include <Eigen/Core>
#include <array>
#include <cmath>
#include <limits>

#include "mapping/scans/ray_cast.hpp"

namespace clearway {

/// A ray on its way through the cells: the state of octomap's computeRayKeys, number for number.
struct RayState {
  std::array<double, 3> next;   ///< length at which the ray leaves its cell along each axis
  std::array<double, 3> delta;  ///< length that the ray needs to cross a cell along each axis
  std::array<int, 3> step;      ///< -1, 0 or 1 cell
  Eigen::Vector3i cell, end;
  double reach;  ///< the cell that the ray leaves beyond this length is not freed, and ends it
};

/// Starts the rays of one scan as computeRayKeys does, with its mixture of float and double.
class RayStarter {
 public:
  RayStarter(const Eigen::Vector3f& origin, double resolution)
      : origin_(origin), resolution_(resolution), factor_(1.0 / resolution) {
    cell_ = cell(origin);
    for (int axis = 0; axis < 3; ++axis) {
      const double centre = (static_cast<double>(cell_[axis]) + 0.5) * resolution;
      for (const int step : {-1, 1}) {
        const double border = centre + static_cast<double>(static_cast<float>(step * resolution * 0.5));
        to_border_[static_cast<std::size_t>(axis)][step > 0 ? 1 : 0] = border - double{origin[axis]};
      }
    }
  }

  const Eigen::Vector3f& origin() const { return origin_; }
  const Eigen::Vector3i& origin_cell() const { return cell_; }
  double resolution() const { return resolution_; }
  double factor() const { return factor_; }
  /// From the origin to the border of its cell along `axis`, in direction -1 (0) or 1 (1).
  double to_border(std::size_t axis, std::size_t forward) const { return to_border_[axis][forward]; }

  /// The cell of a point that has one.
  Eigen::Vector3i cell(const Eigen::Vector3f& point) const {
    Eigen::Vector3i result;
    for (int axis = 0; axis < 3; ++axis)
      result[axis] = static_cast<int>(std::floor(factor_ * double{point[axis]}));
    return result;
  }

  /// Of a ray that ends in another cell than that of the origin.
  RayState start(const RayEnd& ray) const {
    RayState state;
    state.cell = cell_;
    state.end = cell(ray.point);
    const Eigen::Vector3f way(ray.point.x() - origin_.x(), ray.point.y() - origin_.y(),
                              ray.point.z() - origin_.z());
    const float squared = way.x() * way.x() + way.y() * way.y() + way.z() * way.z();
    const auto length = static_cast<float>(std::sqrt(double{squared}));
    state.reach = double{std::min(length, ray.reach)};
    for (std::size_t i = 0; i < 3; ++i) {
      const float direction = way[static_cast<int>(i)] / length;
      state.step[i] = direction > 0.0F ? 1 : direction < 0.0F ? -1 : 0;
      if (state.step[i] == 0) {
        state.next[i] = state.delta[i] = std::numeric_limits<double>::max();
        continue;
      }
      state.next[i] = to_border_[i][state.step[i] > 0 ? 1 : 0] / double{direction};
      state.delta[i] = resolution_ / std::fabs(double{direction});
    }
    return state;
  }

 private:
  Eigen::Vector3f origin_;
  Eigen::Vector3i cell_;
  double resolution_, factor_;
  std::array<std::array<double, 2>, 3> to_border_;
};

/// Calls `mark(cell)` for every cell that computeRayKeys lists after the first, which is the origin's.
template <class Mark>
void walk_ray(RayState ray, const Mark& mark) {
  while (true) {
    const auto& t = ray.next;
    const std::size_t axis = t[0] < t[1] ? (t[0] < t[2] ? 0 : 2) : (t[1] < t[2] ? 1 : 2);
    ray.cell[static_cast<int>(axis)] += ray.step[axis];
    ray.next[axis] += ray.delta[axis];
    if (ray.cell == ray.end || std::min(std::min(t[0], t[1]), t[2]) > ray.reach) return;
    mark(ray.cell);
  }
}

}  // namespace clearway
