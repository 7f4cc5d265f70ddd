#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "planning/geometry/convex_hull.hpp"
#include "planning/geometry/shape.hpp"
#include "tests/worlds/random_world.hpp"

namespace clearway {
namespace hull_cover_test {

using Points = std::vector<Eigen::Vector3d>;

ShapeSurface hull_of(const Points& points) { return {points, hull_triangles(points)}; }

Points some_points(Random& random, int count) {
  Points points;
  const Eigen::Vector3d middle = random.point(1.0);
  const Eigen::Vector3d sizes = random.point(0.5).cwiseAbs() + Eigen::Vector3d::Constant(0.001);
  for (int i = 0; i < count; ++i) points.emplace_back(middle + random.point(1.0).cwiseProduct(sizes));
  return points;
}

/// Of a polygon with equal sides, as thin as a sheet or as long as a rod, turned some way.
Points some_prism(Random& random) {
  const Eigen::Isometry3d pose = random.pose(1.0);
  const int sides = 3 + random.below(40);
  const double radius = random.between(0.01, 0.5), height = std::pow(10.0, random.between(-3.0, 0.5));
  Points points;
  for (int i = 0; i < 2 * sides; ++i) {
    const double angle = 2.0 * std::numbers::pi * (i / 2) / sides;
    points.push_back(pose * Eigen::Vector3d(radius * std::cos(angle), radius * std::sin(angle),
                                            i % 2 == 0 ? 0.0 : height));
  }
  return points;
}

/// Several points in the place of each, a millionth of a millimetre to a millimetre apart.
Points clustered(Random& random, const Points& points) {
  const double apart = std::pow(10.0, random.between(-9.0, -3.0));
  Points clusters;
  for (const Eigen::Vector3d& point : points) {
    for (int i = random.below(4); i >= 0; --i) clusters.push_back(point + random.point(apart));
  }
  return clusters;
}

/// A mixture of a few of the points.
Eigen::Vector3d point_between(Random& random, const Points& points) {
  Eigen::Vector3d sum = Eigen::Vector3d::Zero();
  double weights = 0.0;
  for (int k = random.below(4); k >= 0; --k) {
    const double weight = random.unit() + 1e-3;
    sum += weight * points[static_cast<std::size_t>(random.below(static_cast<int>(points.size())))];
    weights += weight;
  }
  return sum / weights;
}

void expect_covered(Random& random, const Points& points, const std::vector<Sphere>& cover) {
  for (int i = 0; i < 500; ++i) {
    const Eigen::Vector3d point = point_between(random, points);
    EXPECT_TRUE(std::any_of(cover.begin(), cover.end(), [&](const Sphere& sphere) {
      return (point - sphere.center).norm() <= sphere.radius;
    })) << point.transpose();
  }
}

TEST(HullCover, EveryPointOfTheHullIsInSomeOfAtMostSoManySpheres) {
  Random random(2);
  for (int round = 0; round < 120; ++round) {
    const auto points = round % 2 == 0 ? some_points(random, 4 + random.below(60)) : some_prism(random);
    const std::size_t most = 1 + static_cast<std::size_t>(random.below(40));
    const std::vector<Sphere> cover = hull_cover(hull_of(points), most);
    ASSERT_GE(cover.size(), 1u);
    ASSERT_LE(cover.size(), most);
    expect_covered(random, points, cover);
  }
}

TEST(HullCover, CornersThatAreNearlyOneAreCoveredOrNotKnown) {
  Random random(5);
  int known = 0;
  for (int round = 0; round < 60; ++round) {
    const auto points =
        clustered(random, round % 2 == 0 ? some_points(random, 4 + random.below(30)) : some_prism(random));
    const std::vector<Sphere> cover = hull_cover(hull_of(points), 24);
    EXPECT_LE(cover.size(), 24u);
    if (!cover.empty()) expect_covered(random, points, cover);
    known += !cover.empty();
    expect_covered(random, points, Shape::convex(points).sphere_cover());
  }
  EXPECT_GT(known, 20);
}

TEST(HullCover, FewSpheresAlongARodStandOutLittle) {
  const ShapeSurface rod = hull_of(Shape::capsule(0.06, 0.3).surface().corners);
  const HullPlanes planes(rod);
  const std::vector<Sphere> cover = hull_cover(rod, 24);
  EXPECT_LE(cover.size(), 12u);
  for (const Sphere& sphere : cover)
    EXPECT_LE(sphere.radius - planes.inner_radius(sphere.center), 0.13 * 0.06);
}

TEST(HullCover, MoreSpheresNeverStandOutMore) {
  Random random(4);
  for (int round = 0; round < 20; ++round) {
    const ShapeSurface hull = hull_of(round % 2 == 0 ? some_points(random, 30) : some_prism(random));
    const HullPlanes planes(hull);
    double least = HUGE_VAL;
    for (std::size_t most = 1; most < 30; ++most) {
      double stands_out = 0.0;
      for (const Sphere& sphere : hull_cover(hull, most))
        stands_out = std::max(stands_out, sphere.radius - planes.inner_radius(sphere.center));
      EXPECT_LE(stands_out, least);
      least = stands_out;
    }
  }
}

TEST(HullCover, OneSphereIsLittleLargerThanTheSmallest) {
  Points corners;
  for (int i = 0; i < 8; ++i) corners.emplace_back(i & 1 ? 1.0 : 0.0, i & 2 ? 2.0 : 0.0, i & 4 ? 3.0 : 0.0);
  const std::vector<Sphere> cover = hull_cover(hull_of(corners), 1);
  ASSERT_EQ(cover.size(), 1u);
  EXPECT_LE(cover.front().radius, 1.02 * std::sqrt(14.0) / 2.0);
}

TEST(HullCover, FlatPointsHaveNoneAndTheirShapeOneAllTheSame) {
  Random random(3);
  Points points = some_points(random, 30);
  for (Eigen::Vector3d& point : points) point.z() = 0.25;
  EXPECT_TRUE(hull_cover(hull_of(points), 32).empty());
  EXPECT_FALSE(Shape::convex(points).sphere_cover().empty());
}

}  // namespace hull_cover_test
}  // namespace clearway
