#include "planning/geometry/fcl_geometry.hpp"

#include <fcl/geometry/shape/sphere.h>
#include <fcl/narrowphase/collision.h>
#include <gtest/gtest.h>

#include "tests/worlds/random_world.hpp"

namespace clearway {
namespace fcl_geometry_test {

/// Whether FCL finds the point, as a tiny sphere, in touch with the shape.
bool touches(const Shape& shape, const Eigen::Vector3d& point) {
  const fcl::Sphered probe(1e-6);
  fcl::CollisionResultd result;
  return fcl::collide(fcl_geometry(shape).get(), Eigen::Isometry3d::Identity(), &probe,
                      Eigen::Isometry3d(Eigen::Translation3d{point}), fcl::CollisionRequestd(), result) > 0;
}

TEST(FclGeometry, HoldsThePointsThatTheShapeHolds) {
  Random random(1);
  for (const Shape& shape : {Shape::sphere(0.2), Shape::capsule(0.1, 0.4), Shape::cylinder(0.15, 0.3),
                             Shape::box({0.2, 0.5, 0.3})}) {
    int inside = 0;
    for (int i = 0; i < 500; ++i) {
      const Eigen::Vector3d point = random.point(0.3);
      const double distance = shape.signed_distance(point);
      if (std::abs(distance) < 1e-4) continue;
      EXPECT_EQ(touches(shape, point), distance < 0.0) << point.transpose();
      inside += distance < 0.0;
    }
    EXPECT_GT(inside, 20);
  }
}

TEST(FclGeometry, AHullIsThePlacesBelowAllOfItsFaces) {
  const Shape corner = Shape::convex({{0, 0, 0}, {0.4, 0, 0}, {0, 0.4, 0}, {0, 0, 0.4}, {0.1, 0.1, 0.1}});
  Random random(2);
  for (int i = 0; i < 500; ++i) {
    const Eigen::Vector3d point = random.point(0.3);
    const double inside = std::min(point.minCoeff(), 0.4 - point.sum());
    if (std::abs(inside) < 1e-4) continue;
    EXPECT_EQ(touches(corner, point), inside > 0.0) << point.transpose();
  }
}

TEST(FclGeometry, AFlatHullIsTheBoxAroundIt) {
  const Shape plate = Shape::convex({{0, 0, 0.1}, {0.4, 0, 0.1}, {0, 0.4, 0.1}, {0.4, 0.4, 0.1}});
  EXPECT_TRUE(touches(plate, {0.39, 0.39, 0.1}));
  EXPECT_FALSE(touches(plate, {0.41, 0.39, 0.1}));
  EXPECT_FALSE(touches(plate, {0.2, 0.2, 0.1001}));
  EXPECT_EQ(solid(plate).vertices().size(), 8u);
  const Shape box = Shape::box({1, 2, 3});
  EXPECT_EQ(solid(box).edges(), box.edges());
}

}  // namespace fcl_geometry_test
}  // namespace clearway
