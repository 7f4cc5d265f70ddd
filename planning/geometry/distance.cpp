#include <algorithm>
#include <cmath>
#include <limits>

#include "planning/geometry/gjk.hpp"
#include "planning/geometry/segment_distance.hpp"
#include "planning/geometry/shape.hpp"
#include "planning/geometry/sweep_beyond.hpp"

namespace clearway {
namespace {

constexpr int max_iterations = 100;
constexpr double relative_gap = 1e-9;     ///< upper - lower, over the size of the bodies, at which GJK ends
constexpr double rounding_error = 1e-13;  ///< of a support value, over the coordinates that enter it

/// What a proof takes off a separation, twice: so much more than what is asked for is enough.
double above(double enough, double size) { return enough + 2.0 * rounding_error * size; }

/// A placed body as a core and a radius around it: sphere = point, capsule = segment, others = themselves.
struct Placed {
  const Shape& shape;
  Eigen::Matrix3d rotation;
  Eigen::Vector3d center;
  double radius = 0.0;  ///< around the core

  Placed(const Shape& s, const Eigen::Isometry3d& pose, const Eigen::Vector3d& origin)
      : shape(s), rotation(pose.linear()), center(pose.translation() - origin) {
    if (is_round()) radius = shape.radius();
  }
  bool is_round() const { return shape.is_rounded(); }
  bool is_finite() const { return rotation.allFinite() && center.allFinite(); }
  Eigen::Vector3d end(double side) const { return center + rotation.col(2) * (side * shape.length() / 2); }
  /// Farthest point of the core along `direction`.
  Eigen::Vector3d support(const Eigen::Vector3d& direction) const {
    if (is_round()) return end(rotation.col(2).dot(direction) < 0.0 ? -1.0 : 1.0);
    return center + rotation * shape.support(rotation.transpose() * direction);
  }
};

/// The convex hull of a body's core at two poses.
struct Swept {
  Placed begin, end;
  Eigen::Vector3d support(const Eigen::Vector3d& direction) const {
    const Eigen::Vector3d a = begin.support(direction), b = end.support(direction);
    return direction.dot(a) < direction.dot(b) ? b : a;
  }
};

/// What two cores yielded: nearest points, and the best separation that a plane proved.
struct CoreDistance {
  Eigen::Vector3d a = Eigen::Vector3d::Zero(), b = Eigen::Vector3d::Zero();
  double separation = 0.0;  ///< max over directions of (min over B - max over A); certified up to rounding
  bool overlap = false;
};

/// The separation of the cores along the unit direction `n`.
double plane_separation(const Placed& a, const Placed& b, const Eigen::Vector3d& n) {
  return n.dot(b.support(-n)) - n.dot(a.support(n));
}

/// Gilbert, Johnson, Keerthi 1988, from `direction` on. Ends when the proved separation meets the distance of
/// the nearest points, exceeds `enough`, or nothing improves; and when the distance is `too_near`.
template <class Body>
CoreDistance gjk(const Body& a, const Placed& b, Eigen::Vector3d direction, double size, double enough,
                 double too_near = 0.0) {
  CoreDistance result;
  Simplex simplex;
  double last = std::numeric_limits<double>::infinity();
  if (direction.squaredNorm() < 1e-300) direction = Eigen::Vector3d::UnitX();
  for (int i = 0; i < max_iterations; ++i) {
    SupportPoint point;
    point.a = a.support(direction);
    point.b = b.support(-direction);
    point.difference = point.b - point.a;
    const double separation = direction.dot(point.difference) / direction.norm();
    result.separation = std::max(result.separation, separation);
    if (i > 0 && (last - result.separation <= relative_gap * size || result.separation > enough))
      return result;
    if (simplex.add_and_reduce(point)) {
      result.overlap = true;
      return result;
    }
    direction = simplex.nearest();
    const double distance = direction.norm();
    if (distance <= 1e-14 * size) {
      result.overlap = true;
      return result;
    }
    if (distance >= last) return result;  // rounding: no progress
    last = distance;
    result.a = simplex.nearest_a();
    result.b = simplex.nearest_b();
    if (distance <= too_near) return result;
  }
  return result;
}

/// Turns the result of the cores into bounds for the bodies. `size`: of the coordinates, for the rounding
/// margin.
DistanceBounds bounds_of(const CoreDistance& core, double radius_a, double radius_b, double size,
                         const Eigen::Vector3d& origin) {
  DistanceBounds bounds;
  const Eigen::Vector3d gap = core.b - core.a;
  const double length = gap.norm();
  bounds.direction = length > 0.0 ? Eigen::Vector3d(gap / length) : Eigen::Vector3d(Eigen::Vector3d::Zero());
  bounds.point_a = origin + core.a + radius_a * bounds.direction;
  bounds.point_b = origin + core.b - radius_b * bounds.direction;
  if (core.overlap) return bounds;
  bounds.lower = std::max(0.0, core.separation - radius_a - radius_b - rounding_error * size);
  bounds.upper = std::max(bounds.lower, length - radius_a - radius_b);
  return bounds;
}

DistanceBounds round_bodies(const Placed& a, const Placed& b, double size, const Eigen::Vector3d& origin) {
  const NearestPair pair = segment_to_segment(a.end(-1.0), a.end(1.0), b.end(-1.0), b.end(1.0));
  const Eigen::Vector3d n = (pair.b - pair.a).normalized();  // none where the cores meet: no separation
  return bounds_of({pair.a, pair.b, plane_separation(a, b, n)}, a.radius, b.radius, size, origin);
}

}  // namespace

DistanceBounds distance(const Shape& a, const Eigen::Isometry3d& pose_a, const Shape& b,
                        const Eigen::Isometry3d& pose_b, double enough) {
  // Sums near the bodies, not near the map's origin, lose less to rounding.
  const Eigen::Vector3d origin = pose_a.translation();
  const Placed placed_a(a, pose_a, origin), placed_b(b, pose_b, origin);
  const double size = a.bounding_radius() + b.bounding_radius() + placed_b.center.norm();
  if (!placed_a.is_finite() || !placed_b.is_finite()) return {};
  if (placed_a.is_round() && placed_b.is_round()) return round_bodies(placed_a, placed_b, size, origin);
  const double radii = placed_a.radius + placed_b.radius;
  const double enough_of_cores = above(enough + radii, size);
  CoreDistance best = gjk(placed_a, placed_b, placed_b.center, size, enough_of_cores);
  if (!best.overlap && best.separation <= enough_of_cores &&
      (best.b - best.a).norm() - best.separation > 1e-7 * size) {
    // Rounding stopped it short: once more from the direction found, and the better proof of both.
    const CoreDistance again =
        gjk(placed_a, placed_b, placed_a.rotation.rowwise().sum(), size, enough_of_cores);
    const double separation = std::max(best.separation, again.separation);
    if (again.overlap || (again.b - again.a).norm() < (best.b - best.a).norm()) best = again;
    best.separation = separation;
  }
  return bounds_of(best, placed_a.radius, placed_b.radius, size, origin);
}

DistanceBounds distance_to_cube(const Shape& a, const Eigen::Isometry3d& pose_a,
                                const Eigen::Vector3d& cube_center, double cube_edge, double enough) {
  const Placed placed(a, pose_a, cube_center);
  if (!placed.is_round()) {
    const Eigen::Isometry3d pose_b(Eigen::Translation3d{cube_center});
    return distance(a, pose_a, Shape::box(Eigen::Vector3d::Constant(cube_edge)), pose_b, enough);
  }
  const double size = a.bounding_radius() + cube_edge + placed.center.norm();
  if (!placed.is_finite()) return {};
  const Eigen::Vector3d end_0 = placed.end(-1.0), end_1 = placed.end(1.0);
  const NearestPair pair = segment_to_box(end_0, end_1, Eigen::Vector3d::Constant(cube_edge / 2));
  const Eigen::Vector3d n = (pair.b - pair.a).normalized();
  const double separation = -n.cwiseAbs().sum() * cube_edge / 2 - std::max(n.dot(end_0), n.dot(end_1));
  return bounds_of({pair.a, pair.b, separation}, placed.radius, 0.0, size, cube_center);
}

namespace {

DistanceBounds swept_bounds(const Shape& a, const Eigen::Isometry3d& begin, const Eigen::Isometry3d& end,
                            const Eigen::Vector3d& cube_center, double cube_edge,
                            const Eigen::Vector3d& towards, double enough, double too_near) {
  const Swept swept{Placed(a, begin, cube_center), Placed(a, end, cube_center)};
  const Shape cube = Shape::box(Eigen::Vector3d::Constant(cube_edge));
  const Placed placed(cube, Eigen::Isometry3d::Identity(), Eigen::Vector3d::Zero());
  const double size =
      a.bounding_radius() + cube_edge + std::max(swept.begin.center.norm(), swept.end.center.norm());
  if (!swept.begin.is_finite() || !swept.end.is_finite()) return {};
  const double radius = swept.begin.radius;
  const CoreDistance core =
      gjk(swept, placed, towards, size, above(enough + radius, size), too_near + radius);
  return bounds_of(core, radius, 0.0, size, cube_center);
}

}  // namespace

DistanceBounds swept_distance_to_cube(const Shape& a, const Eigen::Isometry3d& begin,
                                      const Eigen::Isometry3d& end, const Eigen::Vector3d& cube_center,
                                      double cube_edge, double enough) {
  const Eigen::Vector3d middle = (begin.translation() + end.translation()) / 2;
  return swept_bounds(a, begin, end, cube_center, cube_edge, cube_center - middle, enough, 0.0);
}

bool is_sweep_beyond(const Shape& a, const Eigen::Isometry3d& begin, const Eigen::Isometry3d& end,
                     const Eigen::Vector3d& cube_center, double cube_edge, const Eigen::Vector3d& towards,
                     double margin) {
  return swept_bounds(a, begin, end, cube_center, cube_edge, towards, margin, margin).lower > margin;
}

}  // namespace clearway
