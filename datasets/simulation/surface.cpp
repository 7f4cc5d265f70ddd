#include "datasets/simulation/surface.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace clearway {
namespace {

/// A meeting in the surface's own frame.
struct LocalHit {
  double along;
  int part;
  Eigen::Vector3d normal;
  double grey;  ///< negative: the surface's own
};

struct LocalRay {
  const Eigen::Vector3d& origin;
  Eigen::Vector3d direction;
  const Eigen::Vector3d &low, &high;  ///< sides of a box, from the origin
  double limit;                       ///< meetings must come before it
};

constexpr double nearest_allowed = 1e-9;
constexpr double tag_white = 235, tag_black = 25, tag_back = 120;

/// Slabs; from inside, the far side is met.
bool meet(const BoxShape&, const LocalRay& ray, LocalHit& hit) {
  int enter_axis = 0, leave_axis = 0;
  double enter = -std::numeric_limits<double>::infinity(), leave = -enter;
  for (int axis = 0; axis < 3; ++axis) {  // not a number, in the plane of a side: neither
    const double inverse = 1.0 / ray.direction[axis], a = ray.low[axis] * inverse,
                 b = ray.high[axis] * inverse;
    const double first = std::min(a, b), last = std::max(a, b);
    if (first > enter) {
      enter = first;
      enter_axis = axis;
    }
    if (last < leave) {
      leave = last;
      leave_axis = axis;
    }
  }
  if (!(enter <= leave)) return false;
  const bool outside = enter > nearest_allowed;
  const int axis = outside ? enter_axis : leave_axis;
  hit.along = outside ? enter : leave;
  if (!(hit.along > nearest_allowed && hit.along < ray.limit)) return false;
  const bool positive_side = (ray.direction[axis] < 0) == outside;
  hit.normal = Eigen::Vector3d::Zero();
  hit.normal[axis] = positive_side ? 1 : -1;
  hit.part = 2 * axis + positive_side;
  return true;
}

bool meet(const SphereShape& sphere, const LocalRay& ray, LocalHit& hit) {
  const double a = ray.direction.squaredNorm(), b = ray.origin.dot(ray.direction);
  const double c = ray.origin.squaredNorm() - sphere.radius * sphere.radius, under_root = b * b - a * c;
  if (under_root < 0) return false;
  const double root = std::sqrt(under_root);
  hit.along = (-b - root) / a;
  if (hit.along <= nearest_allowed) hit.along = (-b + root) / a;
  if (!(hit.along > nearest_allowed && hit.along < ray.limit)) return false;
  hit.normal = (ray.origin + hit.along * ray.direction) / sphere.radius;
  hit.part = 0;
  return true;
}

bool meet(const CylinderShape& cylinder, const LocalRay& ray, LocalHit& hit) {
  const auto origin = ray.origin.head<2>(), direction = ray.direction.head<2>();
  const double a = direction.squaredNorm(), b = origin.dot(direction);
  const double c = origin.squaredNorm() - cylinder.radius * cylinder.radius, half = cylinder.length / 2;
  double best = ray.limit;
  const auto offer = [&](double along, int part) {
    if (!(along > nearest_allowed && along < best)) return;
    best = hit.along = along;
    hit.part = part;
  };
  if (const double under_root = b * b - a * c; a > 0 && under_root >= 0) {
    for (double sign : {-1.0, 1.0}) {
      const double along = (-b + sign * std::sqrt(under_root)) / a;
      if (std::abs(ray.origin.z() + along * ray.direction.z()) <= half) offer(along, 0);
    }
  }
  if (ray.direction.z() != 0) {
    for (int side : {-1, 1}) {
      const double along = (side * half - ray.origin.z()) / ray.direction.z();
      if ((origin + along * direction).squaredNorm() <= cylinder.radius * cylinder.radius)
        offer(along, side + 2);
    }
  }
  if (!(best < ray.limit)) return false;
  const Eigen::Vector3d point = ray.origin + best * ray.direction;
  hit.normal = hit.part == 0 ? Eigen::Vector3d(point.x(), point.y(), 0).normalized()
                             : Eigen::Vector3d(0, 0, hit.part - 2);
  return true;
}

bool meet(const TagShape& tag, const LocalRay& ray, LocalHit& hit) {
  hit.along = -ray.origin.z() / ray.direction.z();
  if (!(hit.along > nearest_allowed && hit.along < ray.limit)) return false;
  const Eigen::Vector3d point = ray.origin + hit.along * ray.direction;
  const double cell = tag.size / 8, x = point.x() / cell + 5, y = 5 - point.y() / cell;
  if (!(x >= 0 && x < 10 && y >= 0 && y < 10)) return false;
  const bool front = ray.origin.z() > 0;
  const bool white = tag.cells[static_cast<size_t>(y) * 10 + static_cast<size_t>(x)];
  hit.part = !front ? 2 : white;
  hit.grey = !front ? tag_back : white ? tag_white : tag_black;
  hit.normal = Eigen::Vector3d::UnitZ();
  return true;
}

/// Written out: Eigen's product of small matrices is a call here, in the innermost of loops.
template <class Turn>
Eigen::Vector3d turned(const Turn& turn, const Eigen::Vector3d& v) {
  return turn.col(0) * v.x() + turn.col(1) * v.y() + turn.col(2) * v.z();
}

Eigen::Vector3d half_of(const BoxShape& box) { return box.size / 2; }
Eigen::Vector3d half_of(const CylinderShape& c) { return {c.radius, c.radius, c.length / 2}; }
Eigen::Vector3d half_of(const SphereShape& sphere) { return Eigen::Vector3d::Constant(sphere.radius); }
Eigen::Vector3d half_of(const TagShape& tag) { return {tag.size * 5 / 8, tag.size * 5 / 8, 0}; }

}  // namespace

Surface::Surface(const SceneShape& shape)
    : map_from_surface_(shape.map_from_shape),
      surface_from_map_(shape.map_from_shape.inverse()),
      grey_(shape.grey) {
  std::visit(
      [this](const auto& geometry) {
        geometry_ = geometry;
        half_ = half_of(geometry);
      },
      shape.geometry);
}

Surface::Surface(const TagShape& tag, const Eigen::Isometry3d& map_from_tag)
    : geometry_(tag),
      map_from_surface_(map_from_tag),
      surface_from_map_(map_from_tag.inverse()),
      grey_(0),
      half_(half_of(tag)) {}

Eigen::Matrix<double, 3, 8> Surface::corners() const {
  Eigen::Matrix<double, 3, 8> corners;
  for (int i = 0; i < 8; ++i)
    corners.col(i) =
        map_from_surface_ * Eigen::Vector3d((i & 1 ? 1 : -1) * half_.x(), (i & 2 ? 1 : -1) * half_.y(),
                                            (i & 4 ? 1 : -1) * half_.z());
  return corners;
}

bool Surface::meet(const Eigen::Vector3d& origin, const Eigen::Vector3d& direction, Hit& nearest) const {
  return SurfaceView(*this, origin).meet(direction, nearest);
}

SurfaceView::SurfaceView(const Surface& surface, const Eigen::Vector3d& origin)
    : surface_(&surface),
      to_center_(surface.map_from_surface_.translation() - origin),
      origin_in_surface_(surface.surface_from_map_ * origin),
      surface_from_map_(surface.surface_from_map_.linear()),
      outside_(to_center_.squaredNorm() - 1.000001 * surface.half_.squaredNorm()) {
  if (const auto* box = std::get_if<BoxShape>(&surface.geometry_)) {
    low_ = -0.5 * box->size - origin_in_surface_;
    high_ = 0.5 * box->size - origin_in_surface_;
  }
}

bool SurfaceView::meet(const Eigen::Vector3d& direction, Hit& nearest) const {
  const double ahead = to_center_.dot(direction);
  if (outside_ * direction.squaredNorm() > ahead * ahead) return false;  // past the sphere around it
  const LocalRay ray{origin_in_surface_, turned(surface_from_map_, direction), low_, high_, nearest.along};
  LocalHit hit{0, 0, Eigen::Vector3d::Zero(), surface_->grey_};
  if (!std::visit([&](const auto& geometry) { return clearway::meet(geometry, ray, hit); },
                  surface_->geometry_))
    return false;
  nearest.along = hit.along;
  nearest.part = hit.part;
  nearest.grey = hit.grey;
  const Eigen::Vector3d normal = turned(surface_from_map_.transpose(), hit.normal);
  nearest.normal = normal.dot(direction) > 0 ? Eigen::Vector3d(-normal) : normal;
  return true;
}

CastResult cast_ray(std::span<const Surface* const> surfaces, const Eigen::Vector3d& origin,
                    const Eigen::Vector3d& direction) {
  CastResult result;
  for (size_t i = 0; i < surfaces.size(); ++i)
    if (surfaces[i]->meet(origin, direction, result.hit)) result.index = static_cast<int>(i);
  return result;
}

std::vector<SurfaceView> views_from(const Eigen::Vector3d& origin, std::span<const Surface> surfaces) {
  std::vector<SurfaceView> views;
  for (const Surface& surface : surfaces) views.emplace_back(surface, origin);
  return views;
}

CastResult cast_ray(std::span<const SurfaceView> surfaces, const Eigen::Vector3d& direction) {
  CastResult result;
  for (size_t i = 0; i < surfaces.size(); ++i)
    if (surfaces[i].meet(direction, result.hit)) result.index = static_cast<int>(i);
  return result;
}

}  // namespace clearway
