#include "planning/geometry/shape.hpp"

#include <array>
#include <cmath>
#include <locale>
#include <sstream>
#include <stdexcept>

#include "planning/geometry/convex_hull.hpp"
#include "planning/geometry/shape_kind.hpp"

namespace clearway {
namespace {

constexpr double rounding = 1.0 + 1e-9;  ///< keeps a cover's union a cover in spite of rounded sums

const std::array<const ShapeKind*, 5>& kinds() {
  static const std::array<const ShapeKind*, 5> all{&sphere_kind(), &capsule_kind(), &cylinder_kind(),
                                                   &box_kind(), &convex_kind()};
  return all;
}

}  // namespace

double checked_size(double value, const char* shape, const char* name, bool may_be_zero) {
  if (std::isfinite(value) && (value > 0.0 || (may_be_zero && value == 0.0))) return value;
  std::ostringstream text;
  text.imbue(std::locale::classic());
  text << shape << " has " << name << " " << value << ", expected a finite number "
       << (may_be_zero ? "not below 0" : "above 0");
  throw std::invalid_argument(text.str());
}

std::vector<ShapeSizes> Shape::sized_kinds() {
  std::vector<ShapeSizes> sized;
  for (const ShapeKind* kind : kinds())
    if (kind->size_count > 0) sized.push_back({kind->name, kind->size_count});
  return sized;
}

Shape Shape::of_sizes(std::string_view name, std::span<const double> sizes) {
  for (const ShapeKind* kind : kinds()) {
    if (kind->size_count == 0 || kind->name != name) continue;
    if (static_cast<int>(sizes.size()) == kind->size_count) return kind->of_sizes(sizes);
  }
  throw std::invalid_argument("no shape is called '" + std::string(name) + "' and has " +
                              std::to_string(sizes.size()) + " sizes");
}

Shape::Kind Shape::kind() const { return kind_->kind; }
std::string_view Shape::name() const { return kind_->name; }
std::vector<double> Shape::sizes() const { return kind_->sizes(*this); }
bool Shape::is_axial() const { return kind_->is_axial(); }
bool Shape::is_rounded() const { return kind_->is_rounded(); }
bool Shape::has_exact_distance() const { return kind_->has_exact_distance(); }
bool Shape::fills_its_box() const { return kind_->fills_its_box(); }

Eigen::Vector3d Shape::support(const Eigen::Vector3d& direction) const {
  return kind_->support(*this, direction);
}

Eigen::AlignedBox3d Shape::bounds(const Eigen::Isometry3d& pose) const { return kind_->bounds(*this, pose); }
double Shape::bounding_radius() const { return kind_->bounding_radius(*this); }
Sphere Shape::bounding_sphere() const { return kind_->bounding_sphere(*this); }
MedialSegment Shape::medial_segment() const { return kind_->medial_segment(*this); }

std::vector<Sphere> Shape::sphere_cover() const {
  std::vector<Sphere> spheres = kind_->sphere_cover(*this);
  for (Sphere& sphere : spheres) sphere.radius *= rounding;
  return spheres;
}

Shape Shape::grown(double padding) const { return padding == 0.0 ? *this : kind_->grown(*this, padding); }

Shape Shape::core(double depth) const { return kind_->core(*this, depth); }

Shape Shape::scaled(double factor) const {
  Shape shape = *this;
  checked_size(factor, "a scaled body", "factor");
  shape.radius_ *= factor;
  shape.length_ *= factor;
  shape.edges_ *= factor;
  shape.box_center_ *= factor;
  for (Eigen::Vector3d& vertex : shape.vertices_) vertex *= factor;
  if (hull_triangles_) shape.hull_triangles_ = std::make_shared<const HullTriangles>();
  return shape;
}

double Shape::signed_distance(const Eigen::Vector3d& point) const {
  return kind_->signed_distance(*this, point);
}

Eigen::Vector3d Shape::offset_to(const Eigen::Vector3d& point) const {
  return kind_->offset_to(*this, point);
}

ShapeSurface Shape::surface() const { return kind_->surface(*this); }

}  // namespace clearway
