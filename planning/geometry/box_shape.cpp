#include <fcl/geometry/shape/box.h>

#include <array>

#include "planning/geometry/boxed.hpp"
#include "planning/geometry/extents.hpp"
#include "planning/geometry/shape_kind.hpp"

namespace clearway {
namespace {

class BoxKind final : public ShapeKind {
 public:
  BoxKind() : ShapeKind(Shape::Kind::box, "box", 3) {}
  bool fills_its_box() const override { return true; }

  Shape of_sizes(std::span<const double> sizes) const override {
    return Shape::box({sizes[0], sizes[1], sizes[2]});
  }
  std::vector<double> sizes(const Shape& s) const override {
    return {s.edges().x(), s.edges().y(), s.edges().z()};
  }

  Vector support(const Shape& s, const Vector& direction) const override {
    const Vector& edges = s.edges();
    return {extents::sign(direction.x()) * edges.x() / 2, extents::sign(direction.y()) * edges.y() / 2,
            extents::sign(direction.z()) * edges.z() / 2};
  }
  Eigen::AlignedBox3d bounds(const Shape& s, const Eigen::Isometry3d& pose) const override {
    const Vector half = pose.linear().cwiseAbs() * (s.edges() / 2);
    return {pose.translation() - half, pose.translation() + half};
  }
  double bounding_radius(const Shape& s) const override { return s.edges().norm() / 2; }
  MedialSegment medial_segment(const Shape& s) const override { return boxed::medial_segment(s); }

  std::vector<Sphere> sphere_cover(const Shape& s) const override {
    const boxed::Cells cells = boxed::cells(s);
    std::vector<Sphere> spheres;
    for (const Vector& center : cells.centers) spheres.push_back(around_cell(cells, center));
    return spheres;
  }

  Shape grown(const Shape& s, double padding) const override {
    return Shape::box((s.edges().array() + 2 * padding).matrix());
  }
  Shape core(const Shape& s, double depth) const override {
    return Shape::box((s.edges().array() - 2 * std::min(depth, 0.25 * s.edges().minCoeff())).matrix());
  }
  double signed_distance(const Shape& s, const Vector& point) const override {
    return boxed::signed_distance(s, point);
  }
  lanes::Numbers signed_distances(const Shape& s, const FourPoints& points) const override {
    return boxed::signed_distances(s, points);
  }
  Vector offset_to(const Shape& s, const Vector& point) const override { return boxed::offset_to(s, point); }
  ShapeSurface surface(const Shape& s) const override { return box_surface(s.edges()); }
  std::shared_ptr<fcl::CollisionGeometryd> fcl_geometry(const Shape& s) const override {
    return std::make_shared<fcl::Boxd>(s.edges());
  }
};

}  // namespace

const ShapeKind& box_kind() {
  static const BoxKind kind;
  return kind;
}

Shape Shape::box(const Eigen::Vector3d& edges) {
  Shape shape(box_kind());
  for (int i = 0; i < 3; ++i) {
    shape.edges_[i] = checked_size(edges[i], "box", std::array{"x edge", "y edge", "z edge"}[i]);
  }
  return shape;
}

}  // namespace clearway
