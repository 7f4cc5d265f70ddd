// The independent check's shapes: flat hulls, which FCL cannot take as they are, have all of their extent.
// And its distances: proved where FCL itself finds none, and never too large.
#include <gtest/gtest.h>

#include "planning/check/path_check_model.hpp"
#include "tests/worlds/random_world.hpp"

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

Robot two_bodies(const Shape& first, const Shape& second) {
  Robot robot;
  robot.links.emplace_back();
  robot.bodies.resize(2);
  robot.bodies[0].shape = first;
  robot.bodies[1].shape = second;
  return robot;
}

TEST(PathCheckFcl, ACornerANanometreOffAFaceIsProvedApartWhicheverBodyItIsOf) {
  constexpr double gap = 1e-9;
  const Eigen::Vector3d voxel = Eigen::Vector3d::Constant(0.05);
  Random random(5);
  for (int i = 0; i < 200; ++i) {
    const Eigen::Vector3d edges(random.between(0.02, 0.6), random.between(0.02, 0.6),
                                random.between(0.02, 0.6));
    const Eigen::Isometry3d box = random.pose(1.0);
    // The corner of the voxel that lies deepest along a face's normal, above a point of that face.
    const int axis = random.below(3);
    const Eigen::Vector3d normal = box.linear().col(axis);
    Eigen::Vector3d on_face = 0.9 * random.point(0.5).cwiseProduct(edges);
    on_face[axis] = edges[axis] / 2 + gap;
    const Eigen::Vector3d corner = -0.5 * voxel.cwiseProduct(normal.cwiseSign());
    const Eigen::Isometry3d cube(Eigen::Translation3d(box * on_face - corner));
    const Robot robot = two_bodies(Shape::box(voxel), Shape::box(edges));
    const FclBodies bodies(robot);
    for (const double distance : {bodies.distance(0, cube, 1, box), bodies.distance(1, box, 0, cube),
                                  bodies.cube_distance(1, box, cube.translation(), voxel.x())}) {
      ASSERT_GT(distance, 0.0);
      ASSERT_LE(distance, gap);
    }
  }
}

/// Upright, where arithmetic says it.
TEST(PathCheckFcl, OfACapsuleAndAVoxelTheDistanceIsExactToATenMillionth) {
  Random random(6);
  const double edge = 0.05;
  for (int i = 0; i < 2000; ++i) {
    const double radius = random.between(0.02, 0.3), length = random.between(0.02, 0.6);
    const Shape capsule = Shape::capsule(radius, length);
    const FclBodies bodies(two_bodies(capsule, capsule));
    const Eigen::Vector3d at = random.point(1.0), cube = random.point(1.0);
    Eigen::Array3d off = (at - cube).cwiseAbs().array() - edge / 2;
    off.z() -= length / 2;
    const double truth = off.max(0.0).matrix().norm() - radius;
    if (truth < 1e-6) continue;
    const double distance = bodies.cube_distance(0, Eigen::Isometry3d(Eigen::Translation3d(at)), cube, edge);
    ASSERT_LE(distance, truth + 1e-15);
    ASSERT_GE(distance, truth - 1e-9 - 1e-7 * truth);
  }
}

TEST(PathCheckFcl, ADistanceIsNeverMoreThanTheTrueOneHoweverFarFromTheOrigin) {
  Random random(5);
  for (const double far : {1.0, 1e3, 1e5}) {
    for (int i = 0; i < 300; ++i) {
      const double a = random.between(0.02, 0.3), b = random.between(0.02, 0.3);
      const FclBodies bodies(two_bodies(Shape::sphere(a), Shape::sphere(b)));
      const Eigen::Isometry3d pose_a = random.pose(far);
      Eigen::Isometry3d pose_b = random.pose(1.0);
      pose_b.translation() =
          pose_a.translation() + random.between(1.001, 1.5) * (a + b) * random.point(1.0).normalized();
      const auto between =  // the digits that a double has no room for
          (pose_b.translation().cast<long double>() - pose_a.translation().cast<long double>()).eval();
      const long double truth = between.norm() - static_cast<long double>(a) - static_cast<long double>(b);
      const double distance = bodies.distance(0, pose_a, 1, pose_b);
      ASSERT_LE(distance, truth) << far;
      ASSERT_GE(distance, truth - 1e-12 * far - 1e-9) << far;
    }
  }
}

/// Where the planes leave a gap FCL is asked, and where one of its solvers is off, the other.
TEST(PathCheckFcl, OfHullsBoxesAndCylindersTheDistanceIsProvedToATenMillionth) {
  Random random(7);
  const auto hull = [&] {
    std::vector<Eigen::Vector3d> corners;
    for (int i = 0; i < 8; ++i) corners.push_back(random.point(0.2));
    return Shape::convex(corners);
  };
  const auto box = [&] { return Shape::box(random.point(0.3).cwiseAbs()); };
  const auto cylinder = [&] { return Shape::cylinder(random.between(0.01, 0.5), random.between(0.01, 0.5)); };
  int apart = 0;
  for (int i = 0; i < 4500; ++i) {
    const Shape a = i % 3 == 0 ? hull() : i % 3 == 1 ? box() : cylinder();
    const Shape b = i % 3 == 0 ? hull() : i % 3 == 1 ? box() : cylinder();
    const FclBodies bodies(two_bodies(a, b));
    const Eigen::Isometry3d pose_a = random.pose(0.5), pose_b = random.pose(0.5);
    const DistanceBounds truth = distance(a, pose_a, b, pose_b);  // the planners' own, another method
    if (truth.lower < 1e-5) continue;
    ++apart;
    const double proved = bodies.distance(0, pose_a, 1, pose_b);
    ASSERT_LE(proved, truth.upper + 1e-9);
    ASSERT_GE(proved, truth.lower - 1e-7);
  }
  EXPECT_GT(apart, 3000);
}

}  // namespace path_check_fcl_test
}  // namespace clearway::check
