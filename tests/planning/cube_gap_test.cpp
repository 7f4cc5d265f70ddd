#include "planning/cube_gap.hpp"

#include <gtest/gtest.h>

#include "tests/planning/random_world.hpp"

namespace clearway {
namespace {

TEST(CubeGap, IsWhatGjkProvesAndNeverMore) {
  Random random(3);
  const std::vector<Shape> shapes{Shape::sphere(0.07), Shape::capsule(0.05, 0.3), Shape::cylinder(0.06, 0.15),
                                  Shape::box({0.1, 0.3, 0.06}),
                                  Shape::convex({{0, 0, 0}, {0.2, 0, 0}, {0, 0.1, 0}, {0.05, 0.05, 0.2}})};
  for (const Shape& shape : shapes) {
    int apart = 0;
    double short_by = 0.0;
    for (int trial = 0; trial < 3000; ++trial) {
      const Eigen::Isometry3d pose = random.pose(0.2);
      const Eigen::Vector3d cube = random.point(0.3);
      const CubeGap gap = CubeGaps(shape, pose, 0.05).to(cube, pose.translation(), 1.0);
      const DistanceBounds bounds = distance_to_cube(shape, pose, cube, 0.05);
      EXPECT_LE(gap.distance, bounds.upper + 1e-12);
      const bool has_faces = shape.kind() == Shape::Kind::cylinder || shape.kind() == Shape::Kind::box;
      EXPECT_GE(gap.distance, bounds.lower - (has_faces ? 0.01 * 0.05 : 1e-9));
      short_by += std::max(0.0, bounds.lower - gap.distance);
      if (bounds.lower < 5e-3) continue;
      ++apart;
      EXPECT_NEAR(gap.normal.norm(), 1.0, 1e-12);
      // The plane through the point has the whole body behind it.
      const Eigen::Vector3d farthest = pose * shape.support(pose.linear().transpose() * gap.normal);
      EXPECT_LE(gap.normal.dot(farthest - gap.point), 1e-9);
    }
    EXPECT_GT(apart, 1000);
    EXPECT_LT(short_by / 3000, 2e-5);
  }
}

TEST(CubeGap, OfWhatOverlapsIsZero) {
  const Eigen::Isometry3d pose = Eigen::Isometry3d::Identity();
  const Shape shape = Shape::capsule(0.05, 0.3);
  const CubeGap gap = CubeGaps(shape, pose, 0.05).to({0.02, 0.0, 0.1}, pose.translation(), 1.0);
  EXPECT_EQ(gap.distance, 0.0);
  EXPECT_EQ(gap.normal, Eigen::Vector3d(0.0, 0.0, 0.0));
}

}  // namespace
}  // namespace clearway
