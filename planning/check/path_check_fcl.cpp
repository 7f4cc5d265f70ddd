#include <fcl/geometry/shape/box.h>
#include <fcl/geometry/shape/capsule.h>
#include <fcl/geometry/shape/convex.h>
#include <fcl/geometry/shape/cylinder.h>
#include <fcl/geometry/shape/sphere.h>
#include <fcl/narrowphase/collision.h>
#include <fcl/narrowphase/distance.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "planning/check/path_check_model.hpp"
#include "planning/geometry/convex_hull.hpp"

namespace clearway::check {
namespace {

/// A body as FCL has it, with the sizes that a separating plane needs.
struct Geometry {
  std::shared_ptr<fcl::CollisionGeometryd> fcl;
  Shape shape;
  Eigen::Vector3d box_half = Eigen::Vector3d::Zero(), box_center = Eigen::Vector3d::Zero();

  /// Largest n.x over the placed body, from the body's sizes alone.
  double farthest(const Eigen::Isometry3d& pose, const Eigen::Vector3d& n) const {
    const Eigen::Vector3d d = pose.linear().transpose() * n;
    const double middle = n.dot(pose.translation());
    switch (shape.kind()) {
      case Shape::Kind::sphere:
        return middle + shape.radius();
      case Shape::Kind::capsule:
        return middle + shape.radius() + std::abs(d.z()) * shape.length() / 2;
      case Shape::Kind::cylinder:
        return middle + shape.radius() * std::hypot(d.x(), d.y()) + std::abs(d.z()) * shape.length() / 2;
      case Shape::Kind::box:
        return middle + d.cwiseAbs().dot(shape.edges()) / 2;
      case Shape::Kind::convex:
        break;
    }
    double most = -1e300;
    for (const Eigen::Vector3d& v : shape.vertices()) most = std::max(most, d.dot(v));
    return middle + most;
  }
};

/// FCL wants faces; a hull that qhull gives none for (flat) becomes the box around it.
std::shared_ptr<fcl::CollisionGeometryd> fcl_hull(const Shape& shape) {
  const auto triangles = hull_triangles(shape.vertices());
  if (triangles.empty()) return nullptr;
  auto faces = std::make_shared<std::vector<int>>();
  for (const auto& triangle : triangles) {
    faces->push_back(3);
    faces->insert(faces->end(), triangle.begin(), triangle.end());
  }
  const auto vertices = std::make_shared<std::vector<fcl::Vector3d>>(shape.vertices());
  return std::make_shared<fcl::Convexd>(vertices, static_cast<int>(triangles.size()), faces);
}

Geometry geometry_of(const Shape& shape) {
  Geometry geometry;
  geometry.shape = shape;
  const double r = shape.radius(), half = shape.length() / 2;
  switch (shape.kind()) {
    case Shape::Kind::sphere:
      geometry.fcl = std::make_shared<fcl::Sphered>(r);
      geometry.box_half = Eigen::Vector3d::Constant(r);
      return geometry;
    case Shape::Kind::capsule:
      geometry.fcl = std::make_shared<fcl::Capsuled>(r, shape.length());
      geometry.box_half = Eigen::Vector3d(r, r, r + half);
      return geometry;
    case Shape::Kind::cylinder:
      geometry.fcl = std::make_shared<fcl::Cylinderd>(r, shape.length());
      geometry.box_half = Eigen::Vector3d(r, r, half);
      return geometry;
    case Shape::Kind::box:
      geometry.fcl = std::make_shared<fcl::Boxd>(shape.edges());
      geometry.box_half = shape.edges() / 2;
      return geometry;
    case Shape::Kind::convex:
      break;
  }
  Eigen::AlignedBox3d box;
  for (const Eigen::Vector3d& v : shape.vertices()) box.extend(v);
  geometry.box_half = (box.sizes() / 2).cwiseMax(1e-9);
  geometry.box_center = box.center();
  geometry.fcl = fcl_hull(shape);
  if (!geometry.fcl) {
    std::vector<Eigen::Vector3d> corners;
    for (int i = 0; i < 8; ++i) {
      const Eigen::Vector3d side((i & 1) != 0 ? 1 : -1, (i & 2) != 0 ? 1 : -1, (i & 4) != 0 ? 1 : -1);
      corners.push_back(geometry.box_center + geometry.box_half.cwiseProduct(side));
    }
    geometry.shape = Shape::convex(corners);
    geometry.fcl = fcl_hull(geometry.shape);
  }
  return geometry;
}

bool collide(const Geometry& a, const Eigen::Isometry3d& pose_a, const Geometry& b,
             const Eigen::Isometry3d& pose_b) {
  fcl::CollisionResultd result;
  return fcl::collide(a.fcl.get(), pose_a, b.fcl.get(), pose_b, fcl::CollisionRequestd(), result) > 0;
}

/// The gap between the planes with normal `n` or `-n` that the bodies touch from either side.
double separation(const Geometry& a, const Eigen::Isometry3d& pose_a, const Geometry& b,
                  const Eigen::Isometry3d& pose_b, const Eigen::Vector3d& n) {
  const double forth = -b.farthest(pose_b, -n) - a.farthest(pose_a, n);
  const double back = -a.farthest(pose_a, -n) - b.farthest(pose_b, n);
  return std::max(forth, back);
}

/// Certified distance: FCL's witness points only propose the planes. One solver's proposal that does not
/// bear out what it claimed is followed by the other's, and by the directions of a box and of the centres.
double certified(const Geometry& a, const Eigen::Isometry3d& pose_a, const Geometry& b,
                 const Eigen::Isometry3d& pose_b) {
  if (collide(a, pose_a, b, pose_b)) return 0.0;
  constexpr double closed = 1e-7;  // metres between claim and proof
  double best = 0.0;
  for (const fcl::GJKSolverType solver : {fcl::GST_LIBCCD, fcl::GST_INDEP}) {
    fcl::DistanceRequestd request(true);
    request.gjk_solver_type = solver;
    request.distance_tolerance = 1e-9;
    fcl::DistanceResultd result;
    const double claim = fcl::distance(a.fcl.get(), pose_a, b.fcl.get(), pose_b, request, result);
    const Eigen::Vector3d gap = result.nearest_points[1] - result.nearest_points[0];
    if (gap.allFinite() && gap.norm() > 0.0)
      best = std::max(best, separation(a, pose_a, b, pose_b, gap.normalized()));
    if (best > 0.0 && claim - best <= closed) break;
  }
  if (best <= 0.0) {
    for (int i = 0; i < 3; ++i) {
      best = std::max(best, separation(a, pose_a, b, pose_b, pose_a.linear().col(i)));
      best = std::max(best, separation(a, pose_a, b, pose_b, pose_b.linear().col(i)));
    }
    const Eigen::Vector3d centers = pose_b.translation() - pose_a.translation();
    if (centers.norm() > 0.0) best = std::max(best, separation(a, pose_a, b, pose_b, centers.normalized()));
  }
  const double size = pose_a.translation().norm() + pose_b.translation().norm() + 1.0;
  return std::max(0.0, best - 1e-13 * size);
}

}  // namespace

struct FclBodies::Geometries {
  std::vector<Geometry> bodies;

  static Geometry cube(double edge) { return geometry_of(Shape::box(Eigen::Vector3d::Constant(edge))); }
  static Eigen::Isometry3d at(const Eigen::Vector3d& center) {
    return Eigen::Isometry3d(Eigen::Translation3d{center});
  }
};

FclBodies::FclBodies(const Robot& robot) : geometries_(std::make_unique<Geometries>()) {
  for (const Body& body : robot.bodies) geometries_->bodies.push_back(geometry_of(body.shape));
}
FclBodies::~FclBodies() = default;

bool FclBodies::touches_cube(std::size_t body, const Eigen::Isometry3d& pose, const Eigen::Vector3d& cube,
                             double edge) const {
  return collide(Geometries::cube(edge), Geometries::at(cube), geometries_->bodies[body], pose);
}

double FclBodies::cube_distance(std::size_t body, const Eigen::Isometry3d& pose, const Eigen::Vector3d& cube,
                                double edge) const {
  return certified(Geometries::cube(edge), Geometries::at(cube), geometries_->bodies[body], pose);
}

bool FclBodies::touch(std::size_t a, const Eigen::Isometry3d& pose_a, std::size_t b,
                      const Eigen::Isometry3d& pose_b) const {
  return collide(geometries_->bodies[a], pose_a, geometries_->bodies[b], pose_b);
}

double FclBodies::distance(std::size_t a, const Eigen::Isometry3d& pose_a, std::size_t b,
                           const Eigen::Isometry3d& pose_b) const {
  return certified(geometries_->bodies[a], pose_a, geometries_->bodies[b], pose_b);
}

const Eigen::Vector3d& FclBodies::box_half(std::size_t body) const {
  return geometries_->bodies[body].box_half;
}
const Eigen::Vector3d& FclBodies::box_center(std::size_t body) const {
  return geometries_->bodies[body].box_center;
}

}  // namespace clearway::check
