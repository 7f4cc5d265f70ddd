#pragma once

// The slow and obvious twin of ConfigurationSpace: every body against every blocked voxel with FCL.

#include <fcl/geometry/shape/box.h>
#include <fcl/narrowphase/collision.h>
#include <fcl/narrowphase/distance.h>

#include <algorithm>
#include <memory>
#include <vector>

#include "planning/geometry/fcl_geometry.hpp"
#include "planning/robot/kinematics.hpp"
#include "planning/robot/robot.hpp"

namespace clearway {

inline bool fcl_collide(const fcl::CollisionGeometryd* a, const Eigen::Isometry3d& pose_a,
                        const fcl::CollisionGeometryd* b, const Eigen::Isometry3d& pose_b) {
  fcl::CollisionResultd result;
  return fcl::collide(a, pose_a, b, pose_b, fcl::CollisionRequestd(), result) > 0;
}

/// Unsigned distance: the smaller of FCL's two solvers, since either alone can be far too large.
inline double fcl_distance(const fcl::CollisionGeometryd* a, const Eigen::Isometry3d& pose_a,
                           const fcl::CollisionGeometryd* b, const Eigen::Isometry3d& pose_b) {
  double least = 1e300;
  for (const fcl::GJKSolverType solver : {fcl::GST_LIBCCD, fcl::GST_INDEP}) {
    fcl::DistanceRequestd request;
    request.gjk_solver_type = solver;
    request.distance_tolerance = 1e-9;
    fcl::DistanceResultd result;
    least = std::min(least, fcl::distance(a, pose_a, b, pose_b, request, result));
  }
  return std::max(least, 0.0);
}

/// A robot among cubes, by brute force. `moving_only`: bodies that some joint moves.
class FclTruth {
 public:
  FclTruth(const Robot& robot, std::vector<Eigen::Vector3d> cubes, double edge)
      : robot_(robot), cubes_(std::move(cubes)), edge_(edge), cube_(edge, edge, edge) {
    for (const Body& body : robot.bodies) geometries_.push_back(fcl_geometry(body.shape));
  }

  bool touches_cube(const LinkPoses& poses) const {
    return any_body(
        [&](std::size_t i, const Eigen::Isometry3d& pose) {
          return std::any_of(cubes_.begin(), cubes_.end(), [&](const Eigen::Vector3d& cube) {
            return is_near(i, pose, cube, 0.0) && fcl_collide(geometries_[i].get(), pose, &cube_, at(cube));
          });
        },
        poses);
  }

  double cube_distance(const LinkPoses& poses, double cap) const {
    double least = cap;
    any_body(
        [&](std::size_t i, const Eigen::Isometry3d& pose) {
          for (const Eigen::Vector3d& cube : cubes_) {
            if (is_near(i, pose, cube, least)) least = std::min(least, body_distance(i, pose, cube));
          }
          return false;
        },
        poses);
    return least;
  }

  double body_distance(std::size_t body, const Eigen::Isometry3d& pose, const Eigen::Vector3d& cube) const {
    if (fcl_collide(geometries_[body].get(), pose, &cube_, at(cube))) return 0.0;
    return fcl_distance(geometries_[body].get(), pose, &cube_, at(cube));
  }

  bool touches_itself(const LinkPoses& poses) const { return self_distance(poses, 0.0) <= 0.0; }

  /// Smallest distance between bodies that are not exempt; with cap 0 only whether they touch.
  double self_distance(const LinkPoses& poses, double cap) const {
    double least = cap > 0.0 ? cap : 1.0;
    for (std::size_t a = 0; a < robot_.bodies.size(); ++a) {
      for (std::size_t b = a + 1; b < robot_.bodies.size(); ++b) {
        const std::pair<int, int> pair(static_cast<int>(a), static_cast<int>(b));
        if (std::find(robot_.exempt.begin(), robot_.exempt.end(), pair) != robot_.exempt.end()) continue;
        if (fcl_collide(geometries_[a].get(), place(a, poses), geometries_[b].get(), place(b, poses)))
          return 0.0;
        if (cap <= 0.0) continue;
        least = std::min(least, fcl_distance(geometries_[a].get(), place(a, poses), geometries_[b].get(),
                                             place(b, poses)));
      }
    }
    return least;
  }

  Eigen::Isometry3d place(std::size_t body, const LinkPoses& poses) const {
    return poses[static_cast<std::size_t>(robot_.bodies[body].link)] * robot_.bodies[body].link_from_shape;
  }

 private:
  static Eigen::Isometry3d at(const Eigen::Vector3d& point) {
    return Eigen::Isometry3d(Eigen::Translation3d{point});
  }

  bool is_near(std::size_t body, const Eigen::Isometry3d& pose, const Eigen::Vector3d& cube,
               double margin) const {
    const double reach = robot_.bodies[body].shape.bounding_radius() + 0.87 * edge_ + margin;
    return (pose.translation() - cube).squaredNorm() <= reach * reach;
  }

  template <typename Test>
  bool any_body(const Test& test, const LinkPoses& poses) const {
    for (std::size_t i = 0; i < robot_.bodies.size(); ++i) {
      bool moved = false;
      for (int link = robot_.bodies[i].link; link >= 0;
           link = robot_.links[static_cast<std::size_t>(link)].parent) {
        moved = moved || robot_.links[static_cast<std::size_t>(link)].joint >= 0;
      }
      if (moved && test(i, place(i, poses))) return true;
    }
    return false;
  }

  const Robot& robot_;
  std::vector<Eigen::Vector3d> cubes_;
  double edge_;
  fcl::Boxd cube_;
  std::vector<std::shared_ptr<fcl::CollisionGeometryd>> geometries_;
};

}  // namespace clearway
