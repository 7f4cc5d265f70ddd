#pragma once

// A robot's bodies as FCL has them, and FCL's distance with witness points.

#include <fcl/geometry/shape/box.h>
#include <fcl/geometry/shape/capsule.h>
#include <fcl/geometry/shape/cylinder.h>
#include <fcl/geometry/shape/sphere.h>
#include <fcl/narrowphase/distance.h>

#include <memory>
#include <stdexcept>
#include <vector>

#include "planning/kinematics.hpp"

namespace clearway::bench {

struct FclBodies {
  std::vector<std::shared_ptr<fcl::CollisionGeometryd>> shapes;

  /// @throws std::invalid_argument for hulls of meshes.
  explicit FclBodies(const Robot& robot) {
    for (const Body& body : robot.bodies) shapes.push_back(of(body.shape));
  }
  static Eigen::Isometry3d pose(const Robot& robot, std::size_t body, const LinkPoses& poses) {
    return poses[static_cast<std::size_t>(robot.bodies[body].link)] * robot.bodies[body].link_from_shape;
  }

 private:
  static std::shared_ptr<fcl::CollisionGeometryd> of(const Shape& shape) {
    switch (shape.kind()) {
      case Shape::Kind::sphere:
        return std::make_shared<fcl::Sphered>(shape.radius());
      case Shape::Kind::capsule:
        return std::make_shared<fcl::Capsuled>(shape.radius(), shape.length());
      case Shape::Kind::cylinder:
        return std::make_shared<fcl::Cylinderd>(shape.radius(), shape.length());
      case Shape::Kind::box:
        return std::make_shared<fcl::Boxd>(shape.edges());
      case Shape::Kind::convex:
        break;
    }
    throw std::invalid_argument("FCL bodies of a benchmark: expected no meshes");
  }
};

struct FclDistance {
  double distance = 0.0;  ///< -1 when they overlap
  Eigen::Vector3d a = Eigen::Vector3d::Zero(), b = Eigen::Vector3d::Zero();
};

inline FclDistance fcl_distance(const fcl::CollisionGeometryd& a, const Eigen::Isometry3d& pose_a,
                                const fcl::CollisionGeometryd& b, const Eigen::Isometry3d& pose_b,
                                fcl::GJKSolverType solver = fcl::GST_LIBCCD) {
  fcl::DistanceRequestd request(true);
  request.gjk_solver_type = solver;
  fcl::DistanceResultd result;
  const double distance = fcl::distance(&a, pose_a, &b, pose_b, request, result);
  return {distance, result.nearest_points[0], result.nearest_points[1]};
}

}  // namespace clearway::bench
