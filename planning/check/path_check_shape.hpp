#pragma once

#include "planning/geometry/shape.hpp"

namespace clearway::check {

// Sizes of shapes, worked out anew: the check trusts none that planners use.

/// Largest n.x over the placed shape. @param n unit
double farthest(const Shape& shape, const Eigen::Isometry3d& pose, const Eigen::Vector3d& n);

/// No point of the shape is farther from its origin.
double extent(const Shape& shape);

}  // namespace clearway::check
