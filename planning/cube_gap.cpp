#include "planning/cube_gap.hpp"

#include <algorithm>
#include <cmath>

namespace clearway {
namespace {

CubeGap proved_gap(const Shape& shape, const Eigen::Isometry3d& map_from_shape, const Eigen::Vector3d& cube,
                   double edge, double enough) {
  const DistanceBounds bounds = distance_to_cube(shape, map_from_shape, cube, edge, enough);
  if (bounds.upper <= 0.0) return {};
  return {bounds.lower, bounds.point_a, bounds.direction};
}

}  // namespace

CubeGap cube_gap(const Shape& shape, const Eigen::Isometry3d& map_from_shape, const Eigen::Vector3d& cube,
                 double edge, const Eigen::Vector3d& towards, double enough) {
  if (shape.kind() != Shape::Kind::cylinder && shape.kind() != Shape::Kind::box)
    return proved_gap(shape, map_from_shape, cube, edge, enough);
  CubeGap gap;
  constexpr int closely = 4, most = 12;  // looks
  const double half = 0.5 * edge, rounding = 1e-13 * (1.0 + cube.cwiseAbs().maxCoeff());
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
  const CubeGap proved = proved_gap(shape, map_from_shape, cube, edge, enough);
  return proved.distance > gap.distance ? proved : gap;
}

}  // namespace clearway
