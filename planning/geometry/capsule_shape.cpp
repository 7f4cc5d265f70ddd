#include <fcl/geometry/shape/capsule.h>

#include <algorithm>
#include <cmath>

#include "planning/geometry/extents.hpp"
#include "planning/geometry/rounded.hpp"
#include "planning/geometry/shape_kind.hpp"

namespace clearway {
namespace {

constexpr double capsule_excess = 1.1;  ///< radius of a sphere of the cover over that of the capsule

class CapsuleKind final : public ShapeKind {
 public:
  CapsuleKind() : ShapeKind(Shape::Kind::capsule, "capsule", 2) {}
  bool is_axial() const override { return true; }
  bool is_rounded() const override { return true; }

  Shape of_sizes(std::span<const double> sizes) const override { return Shape::capsule(sizes[0], sizes[1]); }
  std::vector<double> sizes(const Shape& s) const override { return {s.radius(), s.length()}; }

  Vector support(const Shape& s, const Vector& direction) const override {
    Vector point = rounded::support(s.radius(), direction);
    point.z() += extents::sign(direction.z()) * s.length() / 2;
    return point;
  }
  Eigen::AlignedBox3d bounds(const Shape& s, const Eigen::Isometry3d& pose) const override {
    const Vector half = Vector::Constant(s.radius()) + pose.linear().col(2).cwiseAbs() * (s.length() / 2);
    return {pose.translation() - half, pose.translation() + half};
  }
  double bounding_radius(const Shape& s) const override { return s.radius() + s.length() / 2; }
  MedialSegment medial_segment(const Shape& s) const override {
    return {
        .half_length = s.length() / 2, .half_extent = s.length() / 2 + s.radius(), .width = 2.0 * s.radius()};
  }

  /// Equal spheres on the axis, from cap to cap.
  std::vector<Sphere> sphere_cover(const Shape& s) const override {
    const double spacing = 2.0 * s.radius() * std::sqrt(capsule_excess * capsule_excess - 1.0);
    const std::size_t gaps =
        std::min(static_cast<std::size_t>(std::ceil(s.length() / spacing)), most_cover_spheres - 1);
    if (gaps == 0) return {{Vector::Zero(), s.radius()}};
    const double step = s.length() / static_cast<double>(gaps);
    std::vector<Sphere> spheres;
    for (std::size_t i = 0; i <= gaps; ++i) {
      spheres.push_back(
          {{0.0, 0.0, -s.length() / 2 + step * static_cast<double>(i)}, std::hypot(s.radius(), step / 2)});
    }
    return spheres;
  }

  Shape grown(const Shape& s, double padding) const override {
    return Shape::capsule(s.radius() + padding, s.length());
  }
  Shape core(const Shape& s, double depth) const override {
    return Shape::capsule(s.radius() - std::min(depth, 0.5 * s.radius()), s.length());
  }
  double signed_distance(const Shape& s, const Vector& point) const override {
    const double beyond = std::max(std::abs(point.z()) - s.length() / 2, 0.0);
    return Vector(point.x(), point.y(), beyond).norm() - s.radius();
  }
  lanes::Numbers signed_distances(const Shape& s, const FourPoints& points) const override {
    return rounded::signed_distances(s.radius(), s.length() / 2, points);
  }
  Vector offset_to(const Shape& s, const Vector& point) const override {
    return rounded::offset_to(s.radius(), {point.x(), point.y(), extents::past(point.z(), s.length() / 2)});
  }
  ShapeSurface surface(const Shape& s) const override { return capsule_surface(s.radius(), s.length()); }
  std::shared_ptr<fcl::CollisionGeometryd> fcl_geometry(const Shape& s) const override {
    return std::make_shared<fcl::Capsuled>(s.radius(), s.length());
  }
};

}  // namespace

const ShapeKind& capsule_kind() {
  static const CapsuleKind kind;
  return kind;
}

Shape Shape::capsule(double radius, double length) {
  Shape shape(capsule_kind());
  shape.radius_ = checked_size(radius, "capsule", "radius");
  shape.length_ = checked_size(length, "capsule", "length", true);
  return shape;
}

}  // namespace clearway
