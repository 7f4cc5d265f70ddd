// Bounds of shapes as the check works them out, against points of each shape.
#include "planning/check/path_check_shape.hpp"

#include <gtest/gtest.h>

#include "tests/worlds/random_world.hpp"

namespace clearway {
namespace path_check_shape_test {

std::vector<Eigen::Vector3d> random_corners(Random& random) {
  const Eigen::Vector3d middle = random.point(0.3);  // a hull need not lie about its origin
  std::vector<Eigen::Vector3d> corners;
  for (int i = 0; i < 12; ++i) corners.push_back(middle + random.point(0.2));
  return corners;
}

/// A point of the hull of the corners.
Eigen::Vector3d mixed(const std::vector<Eigen::Vector3d>& corners, Random& random) {
  Eigen::Vector3d sum = Eigen::Vector3d::Zero();
  double weights = 0.0;
  for (const Eigen::Vector3d& corner : corners) {
    const double weight = std::pow(random.unit(), 4.0);
    sum += weight * corner;
    weights += weight;
  }
  return sum / weights;
}

TEST(ShapeReading, NoPointOfAHullIsNearerThanItsBox) {
  Random random(31);
  for (int i = 0; i < 500; ++i) {
    const Shape hull = Shape::convex(random_corners(random));
    const check::ShapeReading reading(hull);
    const Eigen::Isometry3d pose = random.pose(1.0);
    const Eigen::Vector3d point = random.point(1.0);
    const double bound = (reading.nearest_of_core(pose, point) - point).norm();
    Eigen::AlignedBox3d box;
    for (const Eigen::Vector3d& corner : hull.vertices()) box.extend(corner);
    EXPECT_NEAR(bound, box.exteriorDistance(Eigen::Vector3d(pose.inverse() * point)), 1e-12) << i;
    for (int k = 0; k < 50; ++k)
      ASSERT_LE(bound, (pose * mixed(hull.vertices(), random) - point).norm() + 1e-12) << i;
  }
}

TEST(ShapeReading, NoPointOfAHullIsFartherThanItsSupportOrExtent) {
  Random random(32);
  for (int i = 0; i < 500; ++i) {
    const Shape hull = Shape::convex(random_corners(random));
    const Eigen::Isometry3d pose = random.pose(1.0);
    const Eigen::Vector3d n = random.point(1.0).normalized();
    const double most = check::farthest(hull, pose, n), extent = check::extent(hull);
    double reached = -1e300;
    for (const Eigen::Vector3d& corner : hull.vertices()) {
      reached = std::max(reached, n.dot(pose * corner));
      EXPECT_LE(corner.norm(), extent + 1e-12) << i;
    }
    EXPECT_NEAR(most, reached, 1e-12) << i;
  }
}

std::vector<Shape> exact_shapes(Random& random) {
  const double radius = random.between(0.02, 0.3), length = random.between(0.02, 0.6);
  return {Shape::sphere(radius), Shape::capsule(radius, length), Shape::cylinder(radius, length),
          Shape::box({random.between(0.02, 0.6), random.between(0.02, 0.6), random.between(0.02, 0.6)})};
}

/// Against the shapes' own arithmetic, in which the check has no part.
TEST(ShapeReading, OfEachKindSupportAndNearestPointAreThoseOfTheShape) {
  Random random(33);
  for (int i = 0; i < 300; ++i) {
    for (const Shape& shape : exact_shapes(random)) {
      const check::ShapeReading reading(shape);
      const Eigen::Isometry3d pose = random.pose(1.0);
      for (const Eigen::Vector3d& n :
           {Eigen::Vector3d(random.point(1.0).normalized()), Eigen::Vector3d(pose.linear().col(2)),
            Eigen::Vector3d(-pose.linear().col(0))}) {
        const Eigen::Vector3d tip = shape.support(pose.linear().transpose() * n);
        EXPECT_NEAR(check::farthest(shape, pose, n), n.dot(pose * tip), 1e-12);
        EXPECT_LE(tip.norm(), check::extent(shape) + 1e-12);
      }
      const Eigen::Vector3d point = random.point(1.5), own = pose.inverse() * point;
      const Eigen::Vector3d nearest = reading.nearest_of_core(pose, point);
      EXPECT_LE(shape.signed_distance(pose.inverse() * nearest), -reading.round + 1e-12);
      EXPECT_TRUE(reading.is_exact());
      if (shape.signed_distance(own) <= 0.0) continue;
      EXPECT_NEAR((nearest - point).norm() - reading.round, shape.signed_distance(own), 1e-12);
    }
  }
}

TEST(ShapeReading, ExtentsAreThoseOfTheFarthestPoints) {
  EXPECT_EQ(check::extent(Shape::sphere(0.2)), 0.2);
  EXPECT_NEAR(check::extent(Shape::capsule(0.2, 0.5)), 0.45, 1e-15);
  EXPECT_NEAR(check::extent(Shape::cylinder(0.2, 0.5)), 0.45, 1e-15);  // no less than 0.32, and simply found
  EXPECT_NEAR(check::extent(Shape::box({0.2, 0.4, 0.4})), 0.3, 1e-15);
  EXPECT_NEAR(check::extent(Shape::convex({{0, 0, 0}, {0.1, 0, 0}, {0, 0.3, 0.4}, {0.1, 0.1, 0.1}})), 0.5,
              1e-15);
}

}  // namespace path_check_shape_test
}  // namespace clearway
