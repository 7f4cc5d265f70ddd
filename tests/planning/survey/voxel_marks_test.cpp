#include "planning/survey/voxel_marks.hpp"

#include <gtest/gtest.h>

#include "tests/worlds/random_world.hpp"

namespace clearway {
namespace voxel_marks_test {

Shape some_hull(Random& random) {
  std::vector<Eigen::Vector3d> corners;
  for (int i = 0; i < 60; ++i) corners.push_back(random.point(1.0).normalized());
  return Shape::convex(corners);
}

TEST(MarkedShape, DistancesOfAHullAreThoseOfItsFarthestPlane) {
  Random random(1);
  for (int round = 0; round < 20; ++round) {
    const Shape hull = some_hull(random);
    const ShapeSurface surface = hull.surface();
    const MarkedShape marked(hull);
    for (int i = 0; i < 50; ++i) {
      const Eigen::Vector3d point = random.point(1.5);
      double expected = -HUGE_VAL;
      for (const auto& [a, b, c] : surface.triangles) {
        const auto corner = [&](int k) { return surface.corners[static_cast<std::size_t>(k)]; };
        const Eigen::Vector3d normal = (corner(b) - corner(a)).cross(corner(c) - corner(a)).normalized();
        expected = std::max(expected, normal.dot(point - corner(a)));
      }
      EXPECT_NEAR(marked.distances(FourPoints::all(point))[0], expected, 1e-9);
    }
  }
}

TEST(MarkedShape, DistancesBeyondEnoughStayBeyondItAndOthersAreTheSame) {
  Random random(2);
  int beyond = 0, same = 0;
  for (int round = 0; round < 20; ++round) {
    const MarkedShape hull(some_hull(random));
    for (int i = 0; i < 200; ++i) {
      FourPoints points;
      const Eigen::Vector3d middle = random.point(1.2);
      for (int lane = 0; lane < 4; ++lane) points.set(lane, middle + random.point(0.2));
      const double enough = random.between(-0.5, 0.5);
      const lanes::Numbers exact = hull.distances(points), early = hull.distances(points, enough);
      const bool are_beyond = !lanes::any(exact <= lanes::all(enough));
      for (int lane = 0; lane < 4; ++lane) {
        if (are_beyond) {
          EXPECT_GT(early[lane], enough);
          EXPECT_LE(early[lane], exact[lane]);
        } else {
          EXPECT_EQ(early[lane], exact[lane]);
        }
      }
      ++(are_beyond ? beyond : same);
    }
  }
  EXPECT_GT(beyond, 500);
  EXPECT_GT(same, 500);
}

}  // namespace voxel_marks_test
}  // namespace clearway
