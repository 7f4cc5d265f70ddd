#include "planning/check/path_check_planes.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace clearway::check {
namespace {

constexpr int most_projections = 12;
constexpr double rounding_of_a_plane = 1e-13;  ///< over the coordinates that enter it

/// The point of a body's core that is nearest to `point`: the core of a sphere is its centre, of a capsule
/// its axis, of a cylinder or box itself; of a hull the box that holds it. Both in the map frame.
Eigen::Vector3d nearest_point(const Shape& shape, const Eigen::Isometry3d& pose,
                              const Eigen::Vector3d& point) {
  Eigen::Vector3d p = pose.linear().transpose() * (point - pose.translation());
  const double half = shape.length() / 2;
  switch (shape.kind()) {
    case Shape::Kind::sphere:
      return pose.translation();
    case Shape::Kind::capsule:
      return pose.translation() + std::clamp(p.z(), -half, half) * pose.linear().col(2);
    case Shape::Kind::cylinder: {
      const double away = p.head<2>().norm();
      if (away > shape.radius()) p.head<2>() *= shape.radius() / away;
      p.z() = std::clamp(p.z(), -half, half);
      break;
    }
    case Shape::Kind::box:
      p = p.cwiseMax(-shape.edges() / 2).cwiseMin(shape.edges() / 2);
      break;
    case Shape::Kind::convex: {
      Eigen::AlignedBox3d box;
      for (const Eigen::Vector3d& v : shape.vertices()) box.extend(v);
      p = p.cwiseMax(box.min()).cwiseMin(box.max());
      break;
    }
  }
  return pose.translation() + pose.linear() * p;
}

/// The cube of a voxel as a body.
struct Cube {
  const Eigen::Vector3d& center;
  double half;
  Eigen::Vector3d nearest(const Eigen::Vector3d& point) const {
    return point.cwiseMax((center.array() - half).matrix()).cwiseMin((center.array() + half).matrix());
  }
  double reach(const Eigen::Vector3d& n) const { return n.dot(center) + half * n.lpNorm<1>(); }
  double radius() const { return 0.0; }
  double size() const { return center.lpNorm<1>() + half; }
  Eigen::Vector3d middle() const { return center; }
  bool is_exact() const { return true; }
};

struct Placed {
  const Shape& shape;
  const Eigen::Isometry3d& pose;
  Eigen::Vector3d nearest(const Eigen::Vector3d& point) const { return nearest_point(shape, pose, point); }
  double reach(const Eigen::Vector3d& n) const { return farthest(shape, pose, n); }
  double radius() const {  ///< about the core
    const bool is_round = shape.kind() == Shape::Kind::sphere || shape.kind() == Shape::Kind::capsule;
    return is_round ? shape.radius() : 0.0;
  }
  double size() const { return pose.translation().lpNorm<1>() + 1.0; }
  Eigen::Vector3d middle() const { return pose.translation(); }
  bool is_exact() const { return shape.kind() != Shape::Kind::convex; }
};

/// Von Neumann's alternating projections: the points come as near to each other as the cores are, and the
/// planes across the way between them prove ever more of it.
template <class A, class B>
Gap project(const A& a, const B& b, double enough) {
  const bool is_exact = a.is_exact() && b.is_exact();
  const double rounding = rounding_of_a_plane * (a.size() + b.size());
  Gap gap{0.0, std::numeric_limits<double>::infinity()};
  Eigen::Vector3d of_b = b.middle();
  for (int i = 0; i < most_projections; ++i) {
    const Eigen::Vector3d of_a = a.nearest(of_b);
    of_b = b.nearest(of_a);
    const Eigen::Vector3d way = of_b - of_a;
    const double length = way.norm(), found = length - a.radius() - b.radius();
    if (is_exact) gap.found = std::min(gap.found, std::max(found, 0.0));
    if (length < 1e-9 || (is_exact && found <= 0.0)) return gap;
    const Eigen::Vector3d n = way / length;
    gap.proved = std::max(gap.proved, -b.reach(-n) - a.reach(n) - rounding);
    if (gap.proved > enough || gap.is_closed()) break;
  }
  return gap;
}

}  // namespace

Gap cube_gap(const Shape& shape, const Eigen::Isometry3d& pose, const Eigen::Vector3d& cube, double edge,
             double enough) {
  return project(Placed{shape, pose}, Cube{cube, edge / 2}, enough);
}

Gap body_gap(const Shape& a, const Eigen::Isometry3d& pose_a, const Shape& b, const Eigen::Isometry3d& pose_b,
             double enough) {
  return project(Placed{a, pose_a}, Placed{b, pose_b}, enough);
}

}  // namespace clearway::check
