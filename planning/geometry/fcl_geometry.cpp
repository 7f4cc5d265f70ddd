#include "planning/geometry/fcl_geometry.hpp"

#include "planning/geometry/shape_kind.hpp"

namespace clearway {

Shape solid(const Shape& shape) {
  if (shape.has_exact_distance() || !shape.surface().triangles.empty()) return shape;
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

std::shared_ptr<fcl::CollisionGeometry<double>> fcl_geometry(const Shape& shape) {
  const Shape spanned = solid(shape);
  return spanned.kind_functions().fcl_geometry(spanned);
}

}  // namespace clearway
