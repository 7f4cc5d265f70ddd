#include <fcl/geometry/shape/sphere.h>

#include "planning/geometry/rounded.hpp"
#include "planning/geometry/shape_kind.hpp"

namespace clearway {
namespace {

class SphereKind final : public ShapeKind {
 public:
  SphereKind() : ShapeKind(Shape::Kind::sphere, "sphere", 1) {}
  bool is_axial() const override { return true; }
  bool is_rounded() const override { return true; }

  Shape of_sizes(std::span<const double> sizes) const override { return Shape::sphere(sizes[0]); }
  std::vector<double> sizes(const Shape& s) const override { return {s.radius()}; }

  Vector support(const Shape& s, const Vector& direction) const override {
    return rounded::support(s.radius(), direction);
  }
  Eigen::AlignedBox3d bounds(const Shape& s, const Eigen::Isometry3d& pose) const override {
    const Vector half = Vector::Constant(s.radius());
    return {pose.translation() - half, pose.translation() + half};
  }
  double bounding_radius(const Shape& s) const override { return s.radius(); }
  MedialSegment medial_segment(const Shape& s) const override {
    return {.half_extent = s.radius(), .width = 2.0 * s.radius()};
  }
  std::vector<Sphere> sphere_cover(const Shape& s) const override { return {{Vector::Zero(), s.radius()}}; }
  Shape grown(const Shape& s, double padding) const override { return Shape::sphere(s.radius() + padding); }
  Shape core(const Shape& s, double depth) const override {
    return Shape::sphere(s.radius() - std::min(depth, 0.5 * s.radius()));
  }

  double signed_distance(const Shape& s, const Vector& point) const override {
    return point.norm() - s.radius();
  }
  lanes::Numbers signed_distances(const Shape& s, const FourPoints& points) const override {
    return rounded::signed_distances(s.radius(), 0.0, points);
  }
  Vector offset_to(const Shape& s, const Vector& point) const override {
    return rounded::offset_to(s.radius(), point);
  }
  ShapeSurface surface(const Shape& s) const override { return capsule_surface(s.radius(), 0.0); }
  std::shared_ptr<fcl::CollisionGeometryd> fcl_geometry(const Shape& s) const override {
    return std::make_shared<fcl::Sphered>(s.radius());
  }
};

}  // namespace

const ShapeKind& sphere_kind() {
  static const SphereKind kind;
  return kind;
}

Shape Shape::sphere(double radius) {
  Shape shape(sphere_kind());
  shape.radius_ = checked_size(radius, "sphere", "radius");
  return shape;
}

}  // namespace clearway
