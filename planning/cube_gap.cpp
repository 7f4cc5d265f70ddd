#include "planning/cube_gap.hpp"

#include <algorithm>
#include <cmath>

#include "planning/segment_distance.hpp"

namespace clearway {

CubeGaps::CubeGaps(const Shape& shape, const Eigen::Isometry3d& map_from_shape, double edge)
    : shape_(shape),
      map_from_shape_(map_from_shape),
      half_(0.5 * edge),
      middle_(map_from_shape.translation()),
      axis_(map_from_shape.linear().col(2)),
      size_(shape.bounding_radius() + edge) {
  if (shape.kind() == Shape::Kind::capsule || shape.kind() == Shape::Kind::cylinder)
    half_length_ = 0.5 * shape.length();
}

CubeGap CubeGaps::to(const Eigen::Vector3d& cube, const Eigen::Vector3d& towards, double enough) const {
  switch (shape_.kind()) {
    case Shape::Kind::sphere:
    case Shape::Kind::capsule:
      return round_gap(cube);
    case Shape::Kind::cylinder:
    case Shape::Kind::box:
      return projected_gap(cube, towards, enough);
    case Shape::Kind::convex:
      break;
  }
  return proved_gap(cube, enough);
}

CubeGap CubeGaps::proved_gap(const Eigen::Vector3d& cube, double enough) const {
  const DistanceBounds bounds = distance_to_cube(shape_, map_from_shape_, cube, 2.0 * half_, enough);
  if (bounds.upper <= 0.0) return {};
  return {bounds.lower, bounds.point_a, bounds.direction};
}

/// By the plane square to the line between the nearest points of cube and axis.
CubeGap CubeGaps::round_gap(const Eigen::Vector3d& cube) const {
  const Eigen::Vector3d middle = middle_ - cube, along = half_length_ * axis_;
  const double size = size_ + middle.cwiseAbs().sum();
  const NearestPair pair = segment_to_box(middle - along, middle + along, Eigen::Vector3d::Constant(half_));
  if (pair.distance <= shape_.radius() + 1e-13 * size) return {};
  const Eigen::Vector3d normal = (pair.b - pair.a) / pair.distance;
  const double of_axis = normal.dot(middle) + std::abs(normal.dot(along));
  const double apart = -half_ * normal.cwiseAbs().sum() - of_axis - shape_.radius();
  return {std::max(0.0, apart - 1e-13 * size), cube + pair.a + shape_.radius() * normal, normal};
}

/// From the body's nearest point to a point outside.
Eigen::Vector3d CubeGaps::offset_to(const Eigen::Vector3d& point) const {
  const Eigen::Vector3d from_middle = point - middle_;
  if (shape_.kind() != Shape::Kind::cylinder) {
    const auto turned = map_from_shape_.linear();
    return turned * shape_.offset_to(turned.transpose() * from_middle);
  }
  const double along = from_middle.dot(axis_);
  const Eigen::Vector3d aside = from_middle - along * axis_;
  const double squared = aside.squaredNorm(), radius = shape_.radius();
  const double beyond = along - std::clamp(along, -half_length_, half_length_);
  if (squared <= radius * radius) return beyond * axis_;
  return beyond * axis_ + (1.0 - radius / std::sqrt(squared)) * aside;
}

CubeGap CubeGaps::projected_gap(const Eigen::Vector3d& cube, const Eigen::Vector3d& towards,
                                double enough) const {
  constexpr int closely = 4, most = 12;  // looks
  const double rounding = 1e-13 * (1.0 + cube.cwiseAbs().maxCoeff()), edge = 2.0 * half_;
  const auto nearest_of_cube = [&](const Eigen::Vector3d& point) -> Eigen::Vector3d {
    return cube + (point - cube).cwiseMax(-half_).cwiseMin(half_);
  };
  CubeGap gap;
  Eigen::Vector3d on_cube = nearest_of_cube(towards);
  for (int look = 0; look < most; ++look) {
    const Eigen::Vector3d offset = offset_to(on_cube);
    const double distance = offset.norm();
    if (distance <= rounding) return look == 0 || gap.distance <= rounding ? CubeGap{} : gap;
    const Eigen::Vector3d on_body = on_cube - offset;
    // The plane through the body's point, square to the way to the cube's, has the body on one side.
    const double apart = (offset.dot(cube - on_body) - half_ * offset.cwiseAbs().sum()) / distance - rounding;
    gap = {std::max(gap.distance, apart), on_body, offset / distance};
    const double within = (look < closely ? 1e-6 : 1e-2) * edge + 2.0 * rounding;
    if (distance - gap.distance <= within || gap.distance > enough) return gap;
    on_cube = nearest_of_cube(on_body);
  }
  const CubeGap proved = proved_gap(cube, enough);
  return proved.distance > gap.distance ? proved : gap;
}

}  // namespace clearway
