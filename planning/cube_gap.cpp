#include "planning/cube_gap.hpp"

#include <algorithm>
#include <cmath>

namespace clearway {
namespace {

CubeGap by_gjk(const Shape& shape, const Eigen::Isometry3d& map_from_shape, const Eigen::Vector3d& cube,
               double edge, double enough) {
  const DistanceBounds bounds = distance_to_cube(shape, map_from_shape, cube, edge, enough);
  if (bounds.upper <= 0.0) return {};
  return {bounds.lower, bounds.point_a, bounds.direction};
}

}  // namespace

CubeGap cube_gap(const Shape& shape, const Eigen::Isometry3d& map_from_shape, const Eigen::Vector3d& cube,
                 double edge, const Eigen::Vector3d& towards, double enough) {
  if (shape.kind() == Shape::Kind::convex) return by_gjk(shape, map_from_shape, cube, edge, enough);
  CubeGap gap;
  constexpr int most = 10;
  const double half = 0.5 * edge, rounding = 1e-13 * (1.0 + cube.cwiseAbs().maxCoeff());
  const auto turned = map_from_shape.linear();
  const auto nearest_of_cube = [&](const Eigen::Vector3d& point) -> Eigen::Vector3d {
    return cube + (point - cube).cwiseMax(-half).cwiseMin(half);
  };
  Eigen::Vector3d on_cube = nearest_of_cube(towards);
  for (int look = 0; look < most; ++look) {
    const Eigen::Vector3d local =
        shape.offset_to(turned.transpose() * (on_cube - map_from_shape.translation()));
    const double distance = local.norm();
    if (distance <= rounding) return look == 0 || gap.distance <= rounding ? CubeGap{} : gap;
    const Eigen::Vector3d offset = turned * local;
    const Eigen::Vector3d on_body = on_cube - offset;
    // The plane through the body's point, square to the way to the cube's, has the body on one side.
    const double apart = (offset.dot(cube - on_body) - half * offset.cwiseAbs().sum()) / distance - rounding;
    gap = {std::max(gap.distance, apart), on_body, offset / distance};
    if (distance - gap.distance <= 1e-6 * edge + 2.0 * rounding || gap.distance > enough) return gap;
    on_cube = nearest_of_cube(on_body);
  }
  const CubeGap proved = by_gjk(shape, map_from_shape, cube, edge, enough);
  return proved.distance > gap.distance ? proved : gap;
}

}  // namespace clearway
