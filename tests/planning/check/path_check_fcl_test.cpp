// The independent check's shapes: flat hulls, which FCL cannot take as they are, have all of their extent.
#include <gtest/gtest.h>

#include "planning/check/path_check_model.hpp"

namespace clearway::check {
namespace path_check_fcl_test {

TEST(PathCheckFcl, AFlatHullReachesToAllOfItsCorners) {
  for (int normal = 0; normal < 3; ++normal) {
    const int u = (normal + 1) % 3, v = (normal + 2) % 3;
    std::vector<Eigen::Vector3d> corners;
    for (const double a : {-0.3, 0.5}) {
      for (const double b : {-0.2, 0.4}) {
        Eigen::Vector3d corner = Eigen::Vector3d::Zero();
        corner[u] = a;
        corner[v] = b;
        corner[normal] = 0.1;
        corners.push_back(corner);
      }
    }
    Robot robot;
    robot.links.emplace_back();
    robot.bodies.emplace_back();
    robot.bodies[0].part = "plate";
    robot.bodies[0].shape = Shape::convex(corners);
    const FclBodies bodies(robot);
    const Eigen::Isometry3d here = Eigen::Isometry3d::Identity();
    for (const Eigen::Vector3d& corner : corners) {
      EXPECT_TRUE(bodies.touches_cube(0, here, corner, 0.01)) << normal << ": " << corner.transpose();
      Eigen::Vector3d beyond = corner;  // 0.1 m away in the plane, along u
      beyond[u] += (corner[u] > 0.0 ? 1.0 : -1.0) * (0.1 + 0.005);
      EXPECT_FALSE(bodies.touches_cube(0, here, beyond, 0.01));
      const double distance = bodies.cube_distance(0, here, beyond, 0.01);
      EXPECT_LE(distance, 0.1 + 1e-9);
      EXPECT_GE(distance, 0.09);
      beyond = corner;
      beyond[v] += (corner[v] > 0.0 ? 1.0 : -1.0) * (0.1 + 0.005);
      EXPECT_FALSE(bodies.touches_cube(0, here, beyond, 0.01));
      EXPECT_LE(bodies.cube_distance(0, here, beyond, 0.01), 0.1 + 1e-9);
      EXPECT_GE(bodies.cube_distance(0, here, beyond, 0.01), 0.09);
    }
  }
}

}  // namespace path_check_fcl_test
}  // namespace clearway::check
