#include "planning/geometry/fcl_geometry.hpp"

#include <fcl/geometry/shape/box.h>
#include <fcl/geometry/shape/capsule.h>
#include <fcl/geometry/shape/convex.h>
#include <fcl/geometry/shape/cylinder.h>
#include <fcl/geometry/shape/sphere.h>

#include "planning/geometry/convex_hull.hpp"

namespace clearway {
namespace {

std::shared_ptr<fcl::CollisionGeometryd> fcl_hull(const Shape& shape) {
  const auto triangles = hull_triangles(shape.vertices());
  auto faces = std::make_shared<std::vector<int>>();
  for (const auto& triangle : triangles) {
    faces->push_back(3);
    faces->insert(faces->end(), triangle.begin(), triangle.end());
  }
  const auto vertices = std::make_shared<std::vector<fcl::Vector3d>>(shape.vertices());
  return std::make_shared<fcl::Convexd>(vertices, static_cast<int>(triangles.size()), faces);
}

}  // namespace

Shape solid(const Shape& shape) {
  if (shape.kind() != Shape::Kind::convex || !hull_triangles(shape.vertices()).empty()) return shape;
  Eigen::AlignedBox3d box;
  for (const Eigen::Vector3d& vertex : shape.vertices()) box.extend(vertex);
  const Eigen::Vector3d half = (box.sizes() / 2).cwiseMax(1e-9);
  std::vector<Eigen::Vector3d> corners;
  for (int i = 0; i < 8; ++i) {
    const Eigen::Vector3d side((i & 1) != 0 ? 1 : -1, (i & 2) != 0 ? 1 : -1, (i & 4) != 0 ? 1 : -1);
    corners.push_back(box.center() + half.cwiseProduct(side));
  }
  return Shape::convex(std::move(corners));
}

std::shared_ptr<fcl::CollisionGeometryd> fcl_geometry(const Shape& shape) {
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
  return fcl_hull(solid(shape));
}

}  // namespace clearway
