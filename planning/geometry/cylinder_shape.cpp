#include <fcl/geometry/shape/cylinder.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "planning/geometry/extents.hpp"
#include "planning/geometry/shape_kind.hpp"

namespace clearway {
namespace {

/// The disc slab |z - center| <= half_height as one sphere in the middle and eight around it.
void cover_slab(double radius, double center, double half_height, std::vector<Sphere>& spheres) {
  constexpr int sectors = 8;
  const double half_angle = std::numbers::pi / sectors;
  const double inner_radius = 0.4 * radius;
  spheres.push_back({{0.0, 0.0, center}, std::hypot(inner_radius, half_height)});
  // A sector of the ring inner_radius … radius: the circle about (middle, 0) that holds its corners and its
  // arc.
  const double middle = 0.75 * radius;
  const Eigen::Vector2d outer(radius * std::cos(half_angle) - middle, radius * std::sin(half_angle));
  const Eigen::Vector2d inner(inner_radius * std::cos(half_angle) - middle,
                              inner_radius * std::sin(half_angle));
  const double flat = std::max({outer.norm(), inner.norm(), radius - middle, middle - inner_radius});
  for (int i = 0; i < sectors; ++i) {
    const double angle = 2.0 * half_angle * i;
    spheres.push_back(
        {{middle * std::cos(angle), middle * std::sin(angle), center}, std::hypot(flat, half_height)});
  }
}

class CylinderKind final : public ShapeKind {
 public:
  CylinderKind() : ShapeKind(Shape::Kind::cylinder, "cylinder", 2) {}
  bool is_axial() const override { return true; }

  Shape of_sizes(std::span<const double> sizes) const override { return Shape::cylinder(sizes[0], sizes[1]); }
  std::vector<double> sizes(const Shape& s) const override { return {s.radius(), s.length()}; }

  Vector support(const Shape& s, const Vector& direction) const override {
    const double rho = direction.head<2>().norm();
    const double z = extents::sign(direction.z()) * s.length() / 2;
    if (rho == 0.0) return {s.radius(), 0.0, z};
    return {s.radius() * direction.x() / rho, s.radius() * direction.y() / rho, z};
  }
  Eigen::AlignedBox3d bounds(const Shape& s, const Eigen::Isometry3d& pose) const override {
    const Eigen::Matrix3d& rotation = pose.linear();
    Vector half;
    for (int i = 0; i < 3; ++i) {
      half[i] =
          s.radius() * std::hypot(rotation(i, 0), rotation(i, 1)) + std::abs(rotation(i, 2)) * s.length() / 2;
    }
    return {pose.translation() - half, pose.translation() + half};
  }
  double bounding_radius(const Shape& s) const override { return std::hypot(s.radius(), s.length() / 2); }
  MedialSegment medial_segment(const Shape& s) const override {
    return {.half_length = std::max(0.0, s.length() / 2 - s.radius()),
            .half_extent = s.length() / 2,
            .width = 2.0 * s.radius()};
  }

  /// A thin disc is one sphere, as wide as the disc: tight in its plane. A longer cylinder is spheres on the
  /// axis between two end slabs of small spheres, so that no dome of a whole radius sticks out of the ends.
  std::vector<Sphere> sphere_cover(const Shape& s) const override {
    const double radius = s.radius(), length = s.length();
    if (length <= radius / 2) return {{Vector::Zero(), std::hypot(radius, length / 2)}};
    std::vector<Sphere> spheres;
    const double end = std::min(0.55 * radius, length / 2);
    cover_slab(radius, (length - end) / 2, end / 2, spheres);
    cover_slab(radius, -(length - end) / 2, end / 2, spheres);
    const double between = length - 2 * end;
    if (!(between > 0.0)) return spheres;
    const std::size_t count = std::min(static_cast<std::size_t>(std::ceil(between / (0.6 * radius))),
                                       most_cover_spheres - spheres.size());
    const double step = between / static_cast<double>(count);
    for (std::size_t i = 0; i < count; ++i) {
      const double z = -between / 2 + step * (static_cast<double>(i) + 0.5);
      spheres.push_back({{0.0, 0.0, z}, std::hypot(radius, step / 2)});
    }
    return spheres;
  }

  Shape grown(const Shape& s, double padding) const override {
    return Shape::cylinder(s.radius() + padding, s.length() + 2 * padding);
  }
  Shape core(const Shape& s, double depth) const override {
    const double by = std::min({depth, 0.5 * s.radius(), 0.25 * s.length()});
    return Shape::cylinder(s.radius() - by, s.length() - 2 * by);
  }
  double signed_distance(const Shape& s, const Vector& point) const override {
    return extents::distance(
        Eigen::Vector2d(point.head<2>().norm() - s.radius(), std::abs(point.z()) - s.length() / 2));
  }
  lanes::Numbers signed_distances(const Shape& s, const FourPoints& points) const override {
    const lanes::Numbers none = lanes::all(0.0),
                         radial =
                             lanes::root(points.x * points.x + points.y * points.y) - lanes::all(s.radius()),
                         axial = lanes::absolute(points.z) - lanes::all(s.length() / 2),
                         out = lanes::larger(radial, none), past = lanes::larger(axial, none);
    return lanes::root(out * out + past * past) + lanes::smaller(lanes::larger(radial, axial), none);
  }
  Vector offset_to(const Shape& s, const Vector& point) const override {
    const double rho = point.head<2>().norm();
    const double beyond = rho > s.radius() ? 1.0 - s.radius() / rho : 0.0;
    return {point.x() * beyond, point.y() * beyond, extents::past(point.z(), s.length() / 2)};
  }
  ShapeSurface surface(const Shape& s) const override {
    const double half = 0.5 * s.length();
    return surface_of_revolution({{s.radius(), -half}, {s.radius(), half}}, -half, half);
  }
  std::shared_ptr<fcl::CollisionGeometryd> fcl_geometry(const Shape& s) const override {
    return std::make_shared<fcl::Cylinderd>(s.radius(), s.length());
  }
};

}  // namespace

const ShapeKind& cylinder_kind() {
  static const CylinderKind kind;
  return kind;
}

Shape Shape::cylinder(double radius, double length) {
  Shape shape(cylinder_kind());
  shape.radius_ = checked_size(radius, "cylinder", "radius");
  shape.length_ = checked_size(length, "cylinder", "length");
  return shape;
}

}  // namespace clearway
