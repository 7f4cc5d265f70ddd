#include <gtest/gtest.h>

#include <cmath>

#include "planning/geometry/convex_hull.hpp"
#include "planning/geometry/shape.hpp"
#include "tests/worlds/random_world.hpp"

namespace clearway {
namespace hull_cover_test {

std::vector<Eigen::Vector3d> some_points(Random& random, int count) {
  std::vector<Eigen::Vector3d> points;
  const Eigen::Vector3d middle = random.point(1.0);
  const Eigen::Vector3d sizes = random.point(0.5).cwiseAbs() + Eigen::Vector3d::Constant(0.001);
  for (int i = 0; i < count; ++i) points.emplace_back(middle + random.point(1.0).cwiseProduct(sizes));
  return points;
}

TEST(HullCover, EveryPointOfTheHullIsInSomeOfAtMostSoManySpheres) {
  Random random(2);
  for (int round = 0; round < 60; ++round) {
    const auto points = some_points(random, 4 + random.below(60));
    const std::size_t most = 1 + static_cast<std::size_t>(random.below(40));
    const std::vector<Sphere> cover = hull_cover(points, most);
    ASSERT_GE(cover.size(), 1u);
    ASSERT_LE(cover.size(), most);
    for (int i = 0; i < 500; ++i) {
      Eigen::Vector3d point = Eigen::Vector3d::Zero();  // a mixture of a few of them
      double weights = 0.0;
      for (int k = random.below(4); k >= 0; --k) {
        const double weight = random.unit() + 1e-3;
        point += weight * points[static_cast<std::size_t>(random.below(static_cast<int>(points.size())))];
        weights += weight;
      }
      point /= weights;
      EXPECT_TRUE(std::any_of(cover.begin(), cover.end(), [&](const Sphere& sphere) {
        return (point - sphere.center).norm() <= sphere.radius;
      })) << point.transpose();
    }
  }
}

TEST(HullCover, FewSpheresAlongARodStandOutLittle) {
  const auto points = Shape::capsule(0.06, 0.3).surface().corners;
  const HullPlanes planes(points);
  const std::vector<Sphere> cover = hull_cover(points, 24);
  EXPECT_LE(cover.size(), 12u);
  for (const Sphere& sphere : cover)
    EXPECT_LE(sphere.radius - planes.inner_radius(sphere.center), 0.13 * 0.06);
}

TEST(HullCover, MoreSpheresNeverStandOutMore) {
  Random random(4);
  for (int round = 0; round < 20; ++round) {
    const auto points = some_points(random, 30);
    const HullPlanes planes(points);
    double least = HUGE_VAL;
    for (std::size_t most = 1; most < 30; ++most) {
      double stands_out = 0.0;
      for (const Sphere& sphere : hull_cover(points, most))
        stands_out = std::max(stands_out, sphere.radius - planes.inner_radius(sphere.center));
      EXPECT_LE(stands_out, least);
      least = stands_out;
    }
  }
}

TEST(HullCover, OneSphereIsLittleLargerThanTheSmallest) {
  std::vector<Eigen::Vector3d> corners;
  for (int i = 0; i < 8; ++i) corners.emplace_back(i & 1 ? 1.0 : 0.0, i & 2 ? 2.0 : 0.0, i & 4 ? 3.0 : 0.0);
  const std::vector<Sphere> cover = hull_cover(corners, 1);
  ASSERT_EQ(cover.size(), 1u);
  EXPECT_LE(cover.front().radius, 1.02 * std::sqrt(14.0) / 2.0);
}

TEST(HullCover, FlatPointsHaveNoneAndTheirShapeOneAllTheSame) {
  Random random(3);
  std::vector<Eigen::Vector3d> points = some_points(random, 30);
  for (Eigen::Vector3d& point : points) point.z() = 0.25;
  EXPECT_TRUE(hull_cover(points, 32).empty());
  EXPECT_FALSE(Shape::convex(points).sphere_cover().empty());
}

TEST(HullEdges, ABoxHasTwelveAndADiagonalOnEachSide) {
  std::vector<Eigen::Vector3d> corners;
  for (int i = 0; i < 8; ++i) corners.emplace_back(i & 1, (i & 2) / 2, (i & 4) / 4);
  const auto edges = hull_edges(corners);
  EXPECT_EQ(edges.size(), 18u);
  for (const auto& [a, b] : edges) EXPECT_LT(a, b);
}

}  // namespace hull_cover_test
}  // namespace clearway
