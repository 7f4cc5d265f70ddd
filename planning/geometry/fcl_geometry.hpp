#pragma once

#include <memory>

#include "planning/geometry/shape.hpp"

namespace fcl {
template <typename S>
class CollisionGeometry;
}

namespace clearway {

/// The shape itself; a hull without volume, which FCL cannot hold, becomes the box around it, at least 2 nm
/// thick.
Shape solid(const Shape& shape);

/// What FCL has for solid(shape), in the shape's frame.
std::shared_ptr<fcl::CollisionGeometry<double>> fcl_geometry(const Shape& shape);

}  // namespace clearway
