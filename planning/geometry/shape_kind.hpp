#pragma once

// Not part of the installed library.

#include <memory>
#include <optional>
#include <span>

#include "planning/geometry/four_points.hpp"
#include "planning/geometry/shape.hpp"

namespace fcl {
template <typename S>
class CollisionGeometry;
}

namespace clearway {

/// What one kind of shape answers for itself. A new kind is one file beside this (as box_shape.cpp), a line
/// in the table of shape.cpp, and the check's own reading of it (check/path_check_shape.cpp).
class ShapeKind {
 public:
  using Vector = Eigen::Vector3d;

  ShapeKind(Shape::Kind kind, const char* name, int size_count)
      : kind(kind), name(name), size_count(size_count) {}
  virtual ~ShapeKind() = default;
  ShapeKind(const ShapeKind&) = delete;
  ShapeKind& operator=(const ShapeKind&) = delete;

  const Shape::Kind kind;
  const char* const name;
  const int size_count;  ///< numbers that make one; 0: made of its vertices

  // See the functions of Shape with these names.
  virtual bool is_axial() const { return false; }
  virtual bool is_rounded() const { return false; }
  virtual bool has_exact_distance() const { return true; }
  virtual bool fills_its_box() const { return false; }

  /// @pre as many sizes as `size_count`, which is not 0
  virtual Shape of_sizes(std::span<const double> sizes) const = 0;
  virtual std::vector<double> sizes(const Shape& shape) const = 0;

  virtual Vector support(const Shape& shape, const Vector& direction) const = 0;
  virtual Eigen::AlignedBox3d bounds(const Shape& shape, const Eigen::Isometry3d& pose) const = 0;
  virtual double bounding_radius(const Shape& shape) const = 0;
  virtual Sphere bounding_sphere(const Shape& shape) const {
    return {Vector::Zero(), bounding_radius(shape)};
  }
  virtual MedialSegment medial_segment(const Shape& shape) const = 0;
  virtual std::vector<Sphere> sphere_cover(const Shape& shape) const = 0;  ///< but for rounding
  virtual Shape grown(const Shape& shape, double padding) const = 0;       ///< @pre padding > 0
  virtual Shape core(const Shape& shape, double depth) const = 0;
  virtual double signed_distance(const Shape& shape, const Vector& point) const = 0;
  /// The signed distances of four points, those of signed_distance() but for rounding.
  virtual lanes::Numbers signed_distances(const Shape& shape, const FourPoints& points) const = 0;
  virtual Vector offset_to(const Shape& shape, const Vector& point) const = 0;
  virtual ShapeSurface surface(const Shape& shape) const = 0;

  /// What FCL has for it. @pre the shape spans a volume
  virtual std::shared_ptr<fcl::CollisionGeometry<double>> fcl_geometry(const Shape& shape) const = 0;
};

// The kinds, each in its file.
const ShapeKind& sphere_kind();
const ShapeKind& capsule_kind();
const ShapeKind& cylinder_kind();
const ShapeKind& box_kind();
const ShapeKind& convex_kind();

/// `value`, when it is a size that a body can have. @throws std::invalid_argument naming it
double checked_size(double value, const char* shape, const char* name, bool may_be_zero = false);

}  // namespace clearway
