#pragma once

#include <fcl/geometry/shape/box.h>
#include <fcl/geometry/shape/capsule.h>
#include <fcl/geometry/shape/cylinder.h>
#include <fcl/geometry/shape/sphere.h>

#include <memory>
#include <stdexcept>

#include "planning/geometry/shape.hpp"

namespace clearway::bench {

/// A body's shape as FCL has it. @throws std::invalid_argument for hulls of meshes.
inline std::shared_ptr<fcl::CollisionGeometryd> fcl_shape(const Shape& shape) {
  switch (shape.kind()) {
    case Shape::Kind::sphere:
      return std::make_shared<fcl::Sphered>(shape.radius());
    case Shape::Kind::capsule:
      return std::make_shared<fcl::Capsuled>(shape.radius(), shape.length());
    case Shape::Kind::cylinder:
      return std::make_shared<fcl::Cylinderd>(shape.radius(), shape.length());
    case Shape::Kind::box:
      return std::make_shared<fcl::Boxd>(shape.edges());
    case Shape::Kind::convex:
      break;
  }
  throw std::invalid_argument("FCL bodies of a benchmark: expected no meshes");
}

}  // namespace clearway::bench
