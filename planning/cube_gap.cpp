#include "planning/cube_gap.hpp"

#include <algorithm>
#include <cmath>

#include "planning/segment_distance.hpp"

namespace clearway {
namespace {

CubeGap by_gjk(const Shape& shape, const Eigen::Isometry3d& map_from_shape, const Eigen::Vector3d& cube,
               double edge, double enough) {
  const DistanceBounds bounds = distance_to_cube(shape, map_from_shape, cube, edge, enough);
  if (bounds.upper <= 0.0) return {};
  return {bounds.lower, bounds.point_a, bounds.direction};
}

/// A sphere or capsule: the nearest points of its core and the cube, and the plane between them.
CubeGap of_core(const Shape& shape, const Eigen::Isometry3d& map_from_shape, const Eigen::Vector3d& cube,
                double half, double rounding) {
  const double reach = shape.kind() == Shape::Kind::capsule ? shape.length() / 2 : 0.0;
  const Eigen::Vector3d middle = map_from_shape.translation() - cube;
  const Eigen::Vector3d axis = reach * map_from_shape.linear().col(2);
  const Eigen::Vector3d first = middle - axis, last = middle + axis;
  const NearestPair nearest = segment_to_box(first, last, Eigen::Vector3d::Constant(half));
  if (nearest.distance <= rounding) return {};
  const Eigen::Vector3d n = (nearest.b - nearest.a) / nearest.distance;
  const double apart = -half * n.cwiseAbs().sum() - std::max(n.dot(first), n.dot(last)) - shape.radius();
  if (apart <= rounding) return {};
  return {apart - rounding, cube + nearest.a + shape.radius() * n, n};
}

}  // namespace

CubeGap cube_gap(const Shape& shape, const Eigen::Isometry3d& map_from_shape, const Eigen::Vector3d& cube,
                 double edge, const Eigen::Vector3d& towards, double enough) {
  if (shape.kind() == Shape::Kind::convex) return by_gjk(shape, map_from_shape, cube, edge, enough);
  CubeGap gap;
  constexpr int closely = 4, most = 12;  // looks
  const double half = 0.5 * edge, rounding = 1e-13 * (1.0 + cube.cwiseAbs().maxCoeff());
  if (shape.kind() == Shape::Kind::sphere || shape.kind() == Shape::Kind::capsule)
    return of_core(shape, map_from_shape, cube, half, rounding);
  const auto turned = map_from_shape.linear();
  const bool is_cylinder = shape.kind() == Shape::Kind::cylinder;
  const double reach = is_cylinder ? shape.length() / 2 : 0.0;
  const Eigen::Vector3d axis = turned.col(2);
  const auto offset_to = [&](const Eigen::Vector3d& point) -> Eigen::Vector3d {  // from the body
    const Eigen::Vector3d from_middle = point - map_from_shape.translation();
    if (!is_cylinder) return turned * shape.offset_to(turned.transpose() * from_middle);
    const double along = from_middle.dot(axis);
    const Eigen::Vector3d aside = from_middle - along * axis;
    const double far = aside.norm(), beyond = along - std::clamp(along, -reach, reach);
    return far > shape.radius() ? beyond * axis + (1.0 - shape.radius() / far) * aside
                                : Eigen::Vector3d(beyond * axis);
  };
  const auto nearest_of_cube = [&](const Eigen::Vector3d& point) -> Eigen::Vector3d {
    return cube + (point - cube).cwiseMax(-half).cwiseMin(half);
  };
  Eigen::Vector3d on_cube = nearest_of_cube(towards);
  for (int look = 0; look < most; ++look) {
    const Eigen::Vector3d offset = offset_to(on_cube);
    const double distance = offset.norm();
    if (distance <= rounding) return look == 0 || gap.distance <= rounding ? CubeGap{} : gap;
    const Eigen::Vector3d on_body = on_cube - offset;
    // The plane through the body's point, square to the way to the cube's, has the body on one side.
    const double apart = (offset.dot(cube - on_body) - half * offset.cwiseAbs().sum()) / distance - rounding;
    gap = {std::max(gap.distance, apart), on_body, offset / distance};
    const double within = (look < closely ? 1e-6 : 1e-2) * edge + 2.0 * rounding;
    if (distance - gap.distance <= within || gap.distance > enough) return gap;
    on_cube = nearest_of_cube(on_body);
  }
  const CubeGap proved = by_gjk(shape, map_from_shape, cube, edge, enough);
  return proved.distance > gap.distance ? proved : gap;
}

}  // namespace clearway
