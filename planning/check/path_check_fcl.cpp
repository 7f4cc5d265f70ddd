#include <fcl/narrowphase/collision.h>
#include <fcl/narrowphase/distance.h>

#include <algorithm>
#include <cmath>

#include "planning/check/path_check_model.hpp"
#include "planning/check/path_check_planes.hpp"
#include "planning/check/path_check_shape.hpp"
#include "planning/geometry/fcl_geometry.hpp"

namespace clearway::check {
namespace {

/// A body as FCL has it, with the box around it.
struct Geometry {
  Shape shape;
  ShapeReading reading;
  std::shared_ptr<fcl::CollisionGeometryd> fcl;
  PointDistance point_distance;

  explicit Geometry(const Shape& given) : shape(solid(given)), reading(shape), fcl(fcl_geometry(shape)) {
    point_distance.is_round = reading.core == ShapeReading::Core::disc;
    point_distance.round = reading.round;
    point_distance.disc = reading.disc;
    point_distance.half_length = reading.half_length;
    for (int axis = 0; axis < 3; ++axis) {
      const Eigen::Vector3d unit = Eigen::Vector3d::Unit(axis);
      const double high = reading.farthest(Eigen::Isometry3d::Identity(), unit);
      const double low = -reading.farthest(Eigen::Isometry3d::Identity(), -unit);
      point_distance.box_half[axis] = (high - low) / 2;
      point_distance.box_center[axis] = (low + high) / 2;
    }
  }
  Geometry(Geometry&&) = default;  // never copied: the reading looks at the corners of its own shape
};

bool collide(const Geometry& a, const Eigen::Isometry3d& pose_a, const Geometry& b,
             const Eigen::Isometry3d& pose_b) {
  fcl::CollisionResultd result;
  return fcl::collide(a.fcl.get(), pose_a, b.fcl.get(), pose_b, fcl::CollisionRequestd(), result) > 0;
}

/// The gap between the planes with normal `n` or `-n` that the bodies touch from either side.
double separation(const Geometry& a, const Eigen::Isometry3d& pose_a, const Geometry& b,
                  const Eigen::Isometry3d& pose_b, const Eigen::Vector3d& n) {
  const double forth = -b.reading.farthest(pose_b, -n) - a.reading.farthest(pose_a, n);
  const double back = -a.reading.farthest(pose_a, -n) - b.reading.farthest(pose_b, n);
  return std::max(forth, back);
}

/// Certified distance: FCL's witness points only propose the planes. One solver's proposal that does not
/// bear out what it claimed is followed by the other's, and by the directions of a box and of the centres.
double by_fcl(const Geometry& a, const Eigen::Isometry3d& pose_a, const Geometry& b,
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

  static Geometry cube(double edge) { return Geometry(Shape::box(Eigen::Vector3d::Constant(edge))); }
  static Eigen::Isometry3d at(const Eigen::Vector3d& center) {
    return Eigen::Isometry3d(Eigen::Translation3d{center});
  }
};

FclBodies::FclBodies(const Robot& robot) : geometries_(std::make_unique<Geometries>()) {
  for (const Body& body : robot.bodies) geometries_->bodies.emplace_back(body.shape);
}
FclBodies::~FclBodies() = default;

bool FclBodies::touches_cube(std::size_t body, const Eigen::Isometry3d& pose, const Eigen::Vector3d& cube,
                             double edge) const {
  return collide(Geometries::cube(edge), Geometries::at(cube), geometries_->bodies[body], pose);
}

double FclBodies::cube_distance(std::size_t body, const Eigen::Isometry3d& pose, const Eigen::Vector3d& cube,
                                double edge, double enough) const {
  const Geometry& geometry = geometries_->bodies[body];
  const Gap gap = voxel_gap(geometry.reading, pose, cube, edge, enough);
  if (gap.proves(enough)) return gap.proved;
  return by_fcl(Geometries::cube(edge), Geometries::at(cube), geometry, pose);
}

bool FclBodies::touch(std::size_t a, const Eigen::Isometry3d& pose_a, std::size_t b,
                      const Eigen::Isometry3d& pose_b) const {
  return collide(geometries_->bodies[a], pose_a, geometries_->bodies[b], pose_b);
}

double FclBodies::distance(std::size_t a, const Eigen::Isometry3d& pose_a, std::size_t b,
                           const Eigen::Isometry3d& pose_b, double enough) const {
  const Geometry &first = geometries_->bodies[a], &second = geometries_->bodies[b];
  const Gap gap = body_gap(first.reading, pose_a, second.reading, pose_b, enough);
  if (gap.proves(enough)) return gap.proved;
  return by_fcl(first, pose_a, second, pose_b);
}

const PointDistance& FclBodies::point_distance(std::size_t body) const {
  return geometries_->bodies[body].point_distance;
}

}  // namespace clearway::check
