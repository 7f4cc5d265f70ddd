#pragma once

#include <span>

#include "planning/geometry/shape.hpp"

namespace clearway::check {

// Sizes of shapes, worked out anew: the check trusts none that planners use.

/// A shape as the check reads it, in one place for every kind: all within `round` of a core, in the shape's
/// frame. The core is one of
/// - a disc about z drawn out along z: a sphere (a point), a capsule (a segment), a cylinder;
/// - a box about the origin;
/// - the hull of `corners`, and the box that holds it.
struct ShapeReading {
  enum class Core { disc, box, hull } core = Core::disc;
  double round = 0.0;                                                             ///< m
  double disc = 0.0;                                                              ///< m: radius of the disc
  double half_length = 0.0;                                                       ///< m, of the disc along z
  Eigen::Vector3d low = Eigen::Vector3d::Zero(), high = Eigen::Vector3d::Zero();  ///< box, or box of the hull
  std::span<const Eigen::Vector3d> corners;                                       ///< of the hull

  ShapeReading(const Shape& shape);  ///< looks at the corners of the shape, which must live on

  /// Largest n.x over the placed shape. @param n unit
  double farthest(const Eigen::Isometry3d& pose, const Eigen::Vector3d& n) const;

  /// The point of the core (of a hull: of its box) that is nearest to `point`; both in the map frame.
  Eigen::Vector3d nearest_of_core(const Eigen::Isometry3d& pose, const Eigen::Vector3d& point) const;

  /// nearest_of_core() is exact.
  bool is_exact() const { return core != Core::hull; }
};

/// Largest n.x over the placed shape. @param n unit
double farthest(const Shape& shape, const Eigen::Isometry3d& pose, const Eigen::Vector3d& n);

/// No point of the shape is farther from its origin.
double extent(const Shape& shape);

}  // namespace clearway::check
