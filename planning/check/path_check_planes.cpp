#include "planning/check/path_check_planes.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace clearway::check {
namespace {

constexpr int most_projections = 12;
constexpr double rounding_of_a_plane = 1e-13;  ///< over the coordinates that enter it

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
  const ShapeReading& shape;
  const Eigen::Isometry3d& pose;
  Eigen::Vector3d nearest(const Eigen::Vector3d& point) const { return shape.nearest_of_core(pose, point); }
  double reach(const Eigen::Vector3d& n) const { return shape.farthest(pose, n); }
  double radius() const { return shape.round; }  ///< about the core
  double size() const { return pose.translation().lpNorm<1>() + 1.0; }
  Eigen::Vector3d middle() const { return pose.translation(); }
  bool is_exact() const { return shape.is_exact(); }
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

Gap voxel_gap(const ShapeReading& shape, const Eigen::Isometry3d& pose, const Eigen::Vector3d& cube,
              double edge, double enough) {
  return project(Placed{shape, pose}, Cube{cube, edge / 2}, enough);
}

Gap body_gap(const ShapeReading& a, const Eigen::Isometry3d& pose_a, const ShapeReading& b,
             const Eigen::Isometry3d& pose_b, double enough) {
  return project(Placed{a, pose_a}, Placed{b, pose_b}, enough);
}

}  // namespace clearway::check
