#pragma once

// A robot's bodies as FCL has them, and FCL's distance with witness points.

#include <fcl/narrowphase/distance.h>

#include <memory>
#include <vector>

#include "planning/geometry/fcl_geometry.hpp"
#include "planning/robot/kinematics.hpp"

namespace clearway::bench {

struct FclBodies {
  std::vector<std::shared_ptr<fcl::CollisionGeometryd>> shapes;

  /// @throws std::invalid_argument for hulls of meshes.
  explicit FclBodies(const Robot& robot) {
    for (const Body& body : robot.bodies) shapes.push_back(fcl_geometry(body.shape));
  }
  static Eigen::Isometry3d pose(const Robot& robot, std::size_t body, const LinkPoses& poses) {
    return poses[static_cast<std::size_t>(robot.bodies[body].link)] * robot.bodies[body].link_from_shape;
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
