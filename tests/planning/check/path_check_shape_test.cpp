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

}  // namespace path_check_shape_test
}  // namespace clearway
