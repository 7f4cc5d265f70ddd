// Planes that the independent check proposes to itself, against distances known beforehand.
#include "planning/check/path_check_planes.hpp"

#include <gtest/gtest.h>

#include "planning/check/path_check_model.hpp"
#include "tests/worlds/random_world.hpp"

namespace clearway::check {
namespace path_check_planes_test {

std::vector<Shape> shapes() {
  return {Shape::sphere(0.1), Shape::capsule(0.06, 0.3), Shape::cylinder(0.08, 0.2),
          Shape::box({0.1, 0.3, 0.2}),
          Shape::convex({{0, 0, 0}, {0.2, 0, 0}, {0, 0.3, 0}, {0, 0, 0.2}, {0.1, 0.1, 0.2}})};
}

TEST(PathCheckPlanes, WhatIsProvedIsNeverMoreThanTheTrueDistance) {
  Random random(7);
  int closed = 0, rounds = 0;
  for (const Shape& a : shapes()) {
    for (const Shape& b : shapes()) {
      for (int i = 0; i < 100; ++i, ++rounds) {
        const Eigen::Isometry3d pose_a = random.pose(0.4), pose_b = random.pose(0.4);
        const Gap gap = body_gap(a, pose_a, b, pose_b, HUGE_VAL);
        const DistanceBounds truth = distance(a, pose_a, b, pose_b);  // the planners' own, another method
        ASSERT_LE(gap.proved, truth.upper + 1e-9);
        ASSERT_GE(gap.found, truth.lower - 1e-9);
        closed += gap.proved > 0.0 && gap.is_closed();
        const Gap some = body_gap(a, pose_a, b, pose_b, 0.01);
        ASSERT_LE(some.proved, truth.upper + 1e-9);
        if (truth.lower > 0.011 && gap.is_closed()) {
          ASSERT_GT(some.proved, 0.01);
        }
      }
    }
  }
  EXPECT_GT(3 * closed, rounds);  // or FCL would be asked every time
}

TEST(PathCheckPlanes, OfASphereAndACubeTheDistanceIsThatOfArithmetic) {
  Random random(8);
  for (int i = 0; i < 1'000; ++i) {
    const Eigen::Vector3d at = random.point(1.0), cube = random.point(1.0);
    const double truth = ((at - cube).cwiseAbs().array() - 0.05).max(0.0).matrix().norm() - 0.1;
    const Gap gap =
        voxel_gap(Shape::sphere(0.1), Eigen::Isometry3d(Eigen::Translation3d(at)), cube, 0.1, HUGE_VAL);
    if (truth < 1e-8) {
      ASSERT_LE(gap.proved, std::max(truth, 0.0));
      continue;
    }
    ASSERT_NEAR(gap.proved, truth, 1e-9);
    ASSERT_TRUE(gap.is_closed());
  }
}

TEST(PathCheckPlanes, APointsDistanceFromABodyIsNeverMoreThanTheTrueOne) {
  Robot robot;
  robot.links.emplace_back();
  for (const Shape& shape : shapes()) robot.bodies.emplace_back().shape = shape;
  const FclBodies bodies(robot);
  Random random(9);
  for (std::size_t b = 0; b < robot.bodies.size(); ++b) {
    double widest = 0.0;
    for (int i = 0; i < 1'000; ++i) {
      const Eigen::Vector3d point = random.point(0.5);
      const DistanceBounds truth =
          distance(robot.bodies[b].shape, Eigen::Isometry3d::Identity(), Shape::sphere(1e-9),
                   Eigen::Isometry3d(Eigen::Translation3d(point)));
      ASSERT_LE(bodies.point_distance(b)(point), truth.upper + 1e-8);
      widest = std::max(widest, truth.lower - bodies.point_distance(b)(point));
    }
    if (robot.bodies[b].shape.kind() != Shape::Kind::convex) {
      EXPECT_LT(widest, 1e-6) << b;
    }
  }
}

}  // namespace path_check_planes_test
}  // namespace clearway::check
