#include <fcl/geometry/shape/convex.h>

#include <algorithm>
#include <cmath>
#include <stdexcept>

#include "planning/geometry/boxed.hpp"
#include "planning/geometry/convex_hull.hpp"
#include "planning/geometry/farthest_vertex.hpp"
#include "planning/geometry/shape_kind.hpp"

namespace clearway {
namespace {

constexpr std::size_t most_hull_spheres = 24;  ///< more cost more than they spare

/// Spheres around those cells of the box that meet the hull, which may be flat.
std::vector<Sphere> around_cells(const Shape& s) {
  const boxed::Cells cells = boxed::cells(s);
  const double flat = 1e-6 * s.edges().maxCoeff() + 1e-12;  // a flat mesh has cells of no height
  const Shape cell = Shape::box(cells.edges.cwiseMax(flat));
  std::vector<Sphere> spheres;
  for (const Eigen::Vector3d& center : cells.centers) {
    const Eigen::Isometry3d pose(Eigen::Translation3d{center});
    if (distance(s, Eigen::Isometry3d::Identity(), cell, pose, 0.0).lower > 0.0) continue;
    spheres.push_back(boxed::around_cell(cells, center));
    spheres.back().radius = std::max(spheres.back().radius, 1e-9);
  }
  return spheres;
}

class ConvexKind final : public ShapeKind {
 public:
  ConvexKind() : ShapeKind(Shape::Kind::convex, "convex", 0) {}
  bool has_exact_distance() const override { return false; }

  Shape of_sizes(std::span<const double>) const override {
    throw std::logic_error("a convex body is made of vertices");
  }
  std::vector<double> sizes(const Shape&) const override { return {}; }

  Vector support(const Shape& s, const Vector& direction) const override {
    return s.vertices()[farthest_vertex(s.vertices(), direction)];
  }
  Eigen::AlignedBox3d bounds(const Shape& s, const Eigen::Isometry3d& pose) const override {
    Eigen::AlignedBox3d box;
    for (const Vector& vertex : s.vertices()) box.extend(pose * vertex);
    return box;
  }
  double bounding_radius(const Shape& s) const override {
    return std::sqrt(largest_squared_norm(s.vertices()));
  }
  Sphere bounding_sphere(const Shape& s) const override {
    const Vector middle = bounds(s, Eigen::Isometry3d::Identity()).center();
    double squared = 0.0;
    for (const Vector& vertex : s.vertices()) squared = std::max(squared, (vertex - middle).squaredNorm());
    return {middle, std::sqrt(squared)};
  }
  MedialSegment medial_segment(const Shape& s) const override { return boxed::medial_segment(s); }

  std::vector<Sphere> sphere_cover(const Shape& s) const override {
    const std::vector<Sphere> spheres = hull_cover(surface(s), most_hull_spheres);
    return spheres.empty() ? around_cells(s) : spheres;
  }

  Shape grown(const Shape& s, double padding) const override {
    std::vector<Vector> corners;  // of a cube about each vertex
    for (const Vector& vertex : s.vertices()) {
      for (int i = 0; i < 8; ++i) {
        const Vector side((i & 1) != 0 ? 1 : -1, (i & 2) != 0 ? 1 : -1, (i & 4) != 0 ? 1 : -1);
        corners.push_back(vertex + padding * side);
      }
    }
    return Shape::convex(std::move(corners));
  }
  Shape core(const Shape& s, double depth) const override {
    if (depth <= 0.0) return s;
    const ShapeSurface hull = surface(s);
    Vector middle = Vector::Zero();
    for (const Vector& corner : s.vertices()) middle += corner / static_cast<double>(s.vertices().size());
    double inner = hull.triangles.empty() ? 0.0 : HUGE_VAL;  // from the middle to the nearest face
    for (const auto& [a, b, c] : hull.triangles) {
      const auto corner = [&](int i) { return hull.corners[static_cast<std::size_t>(i)]; };
      const Vector normal = (corner(b) - corner(a)).cross(corner(c) - corner(a));
      if (normal.norm() > 0.0) inner = std::min(inner, normal.normalized().dot(corner(a) - middle));
    }
    std::vector<Vector> corners = corners_behind_faces(s.vertices(), middle, std::min(depth, 0.5 * inner));
    if (corners.size() < 4) {  // a flat hull, or faces that qhull does not close
      corners.clear();
      for (const Vector& corner : s.vertices()) corners.push_back(middle + 0.5 * (corner - middle));
    }
    return Shape::convex(std::move(corners));
  }
  double signed_distance(const Shape& s, const Vector& point) const override {
    return boxed::signed_distance(s, point);
  }
  lanes::Numbers signed_distances(const Shape& s, const FourPoints& points) const override {
    return boxed::signed_distances(s, points);
  }
  Vector offset_to(const Shape& s, const Vector& point) const override { return boxed::offset_to(s, point); }
  ShapeSurface surface(const Shape& s) const override {
    return {s.vertices(), s.hull_triangles().of(s.vertices())};
  }

  std::shared_ptr<fcl::CollisionGeometryd> fcl_geometry(const Shape& s) const override {
    const std::vector<std::array<int, 3>>& triangles = s.hull_triangles().of(s.vertices());
    auto faces = std::make_shared<std::vector<int>>();
    for (const auto& triangle : triangles) {
      faces->push_back(3);
      faces->insert(faces->end(), triangle.begin(), triangle.end());
    }
    const auto vertices = std::make_shared<std::vector<fcl::Vector3d>>(s.vertices());
    return std::make_shared<fcl::Convexd>(vertices, static_cast<int>(triangles.size()), faces);
  }
};

}  // namespace

const ShapeKind& convex_kind() {
  static const ConvexKind kind;
  return kind;
}

Shape Shape::convex(std::vector<Eigen::Vector3d> vertices) {
  if (vertices.empty()) throw std::invalid_argument("a convex body needs at least one vertex, got none");
  for (const Eigen::Vector3d& vertex : vertices) {
    if (!vertex.allFinite()) throw std::invalid_argument("a convex body has a vertex that is not finite");
  }
  Shape shape(convex_kind());
  shape.vertices_ = hull_corners(std::move(vertices));
  shape.hull_triangles_ = std::make_shared<const HullTriangles>();
  Eigen::AlignedBox3d box;
  for (const Eigen::Vector3d& vertex : shape.vertices_) box.extend(vertex);
  shape.edges_ = box.sizes();
  shape.box_center_ = box.center();
  return shape;
}

}  // namespace clearway
