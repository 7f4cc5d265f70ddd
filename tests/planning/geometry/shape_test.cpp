#include "planning/geometry/shape.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <set>

#include "planning/geometry/convex_hull.hpp"
#include "planning/geometry/shape_kind.hpp"
#include "tests/worlds/random_world.hpp"

namespace clearway {
namespace shape_test {

std::vector<Shape> some_shapes(Random& random) {
  std::vector<Eigen::Vector3d> points;
  for (int i = 0; i < 30; ++i) points.push_back(random.point(0.3) + Eigen::Vector3d(0.2, -0.1, 0.4));
  const auto size = [&] { return random.between(0.02, 0.5); };
  return {Shape::sphere(size()),
          Shape::capsule(size(), size()),
          Shape::capsule(0.05, 0.0),
          Shape::cylinder(size(), size()),
          Shape::cylinder(0.2, 0.01),
          Shape::cylinder(0.06, 0.15),
          Shape::box({size(), size(), size()}),
          Shape::convex(points)};
}

/// A random point of the shape: a convex mixture of support points.
Eigen::Vector3d point_inside(const Shape& shape, Random& random) {
  Eigen::Vector3d sum = Eigen::Vector3d::Zero();
  double weights = 0.0;
  const int count = 1 + random.below(4);
  for (int i = 0; i < count; ++i) {
    const double weight = random.unit() + 1e-3;
    sum += weight * shape.support(random.point(1.0));
    weights += weight;
  }
  return sum / weights;
}

TEST(Shape, SphereCoverHoldsEveryPointOfTheBodyWithAtMost64Spheres) {
  Random random(1);
  for (int round = 0; round < 20; ++round) {
    for (const Shape& shape : some_shapes(random)) {
      const std::vector<Sphere> cover = shape.sphere_cover();
      ASSERT_LE(cover.size(), 64u);
      for (int i = 0; i < 500; ++i) {
        const Eigen::Vector3d point = point_inside(shape, random);
        double nearest = 1e300;
        for (const Sphere& sphere : cover)
          nearest = std::min(nearest, (point - sphere.center).norm() - sphere.radius);
        ASSERT_LE(nearest, 0.0) << static_cast<int>(shape.kind()) << " at " << point.transpose();
      }
    }
  }
}

TEST(Shape, SphereCoverStandsOutLittle) {
  const auto excess = [](const Shape& shape) {
    double worst = 0.0;
    for (const Sphere& sphere : shape.sphere_cover())
      worst = std::max(worst, sphere.radius + shape.signed_distance(sphere.center));
    return worst;
  };
  EXPECT_LE(excess(Shape::sphere(0.3)), 1e-6);
  EXPECT_LE(excess(Shape::capsule(0.1, 0.6)), 0.1 * 0.1 + 1e-6);
  EXPECT_LE(excess(Shape::cylinder(0.06, 0.15)), 0.26 * 0.06);
  EXPECT_LE(excess(Shape::box({0.2, 0.2, 0.2})), 0.2 * 0.2);
  EXPECT_LE(Shape::cylinder(0.2, 0.01).sphere_cover().front().radius, 0.2 * 1.001);  // a disc, in its plane
}

TEST(Shape, SupportIsTheFarthestPointAndBoundsTouchTheShape) {
  Random random(2);
  for (const Shape& shape : some_shapes(random)) {
    for (int i = 0; i < 200; ++i) {
      const Eigen::Vector3d direction = random.point(1.0);
      const double far = direction.dot(shape.support(direction));
      EXPECT_GE(far, direction.dot(point_inside(shape, random)) - 1e-12);
      EXPECT_LE(shape.support(direction).norm(), shape.bounding_radius() + 1e-12);
      const Eigen::Isometry3d pose = random.pose(1.0);
      const Eigen::AlignedBox3d box = shape.bounds(pose);
      for (int axis = 0; axis < 3; ++axis) {
        const Eigen::Vector3d up = Eigen::Vector3d::Unit(axis);
        const Eigen::Vector3d top = pose * shape.support(pose.linear().transpose() * up);
        EXPECT_NEAR(top[axis], box.max()[axis], 1e-9);
      }
    }
  }
}

TEST(Shape, SignedDistanceIsNegativeInsideAndTheDistanceOutside) {
  Random random(3);
  for (const Shape& shape : some_shapes(random)) {
    for (int i = 0; i < 300; ++i) {
      EXPECT_LE(shape.signed_distance(point_inside(shape, random)), 1e-12);
      const Eigen::Vector3d point = random.point(1.0);
      const Eigen::Isometry3d at(Eigen::Translation3d{point});
      const double expected = distance(shape, Eigen::Isometry3d::Identity(), Shape::sphere(1e-9), at).upper;
      if (shape.kind() == Shape::Kind::convex) {
        EXPECT_LE(shape.signed_distance(point), expected + 1e-6);
      } else if (expected > 0.0) {
        EXPECT_NEAR(shape.signed_distance(point), expected, 1e-6);
        EXPECT_NEAR(shape.offset_to(point).norm(), expected, 1e-6);
        EXPECT_LT(std::abs(shape.signed_distance(point - shape.offset_to(point))), 1e-9);
      }
    }
  }
}

TEST(Shape, SignedDistancesOfFourPointsAreThoseOfEach) {
  Random random(21);
  for (int round = 0; round < 50; ++round) {
    for (const Shape& shape : some_shapes(random)) {
      FourPoints points;
      for (int lane = 0; lane < 4; ++lane) points.set(lane, random.point(0.6));
      const lanes::Numbers distances = shape.kind_functions().signed_distances(shape, points);
      for (int lane = 0; lane < 4; ++lane)
        ASSERT_NEAR(distances[lane], shape.signed_distance(points.point(lane)), 1e-15) << shape.name();
    }
  }
}

TEST(Shape, AxialShapesAreThoseThatATurnAboutZLeavesAsTheyAre) {
  Random random(5);
  for (const Shape& shape : some_shapes(random)) {
    double change = 0.0, beyond_segment = 0.0;
    for (int i = 0; i < 200; ++i) {
      const Eigen::Vector3d d = random.point(1.0).normalized();
      const Eigen::Vector3d turned = Eigen::AngleAxisd(random.between(0, 3), Eigen::Vector3d::UnitZ()) * d;
      const double far = d.dot(shape.support(d));
      change = std::max(change, std::abs(turned.dot(shape.support(turned)) - far));
      const double of_segment = shape.radius() + std::abs(d.z()) * shape.length() / 2;
      beyond_segment = std::max(beyond_segment, std::abs(far - of_segment));
    }
    EXPECT_EQ(shape.is_axial(), change < 1e-12) << static_cast<int>(shape.kind());
    EXPECT_EQ(shape.is_rounded(), beyond_segment < 1e-12) << static_cast<int>(shape.kind());
  }
}

TEST(Shape, TheBoundingSphereHoldsTheShapeAndIsNoLargerThanNeeded) {
  Random random(6);
  for (const Shape& shape : some_shapes(random)) {
    const Sphere sphere = shape.bounding_sphere();
    double farthest = 0.0;
    for (int i = 0; i < 2'000; ++i) {
      const Eigen::Vector3d point = shape.support(random.point(1.0));
      farthest = std::max(farthest, (point - sphere.center).norm());
    }
    EXPECT_LE(farthest, sphere.radius + 1e-12);
    EXPECT_GE(farthest, 0.99 * sphere.radius);
  }
}

TEST(Shape, TheMedialSegmentLiesHalfTheWidthBelowTheSurface) {
  Random random(7);
  for (const Shape& shape : some_shapes(random)) {
    if (!shape.has_exact_distance()) continue;
    const MedialSegment segment = shape.medial_segment();
    EXPECT_NEAR(segment.half_extent, segment.axis.dot(shape.support(segment.axis)), 1e-12);
    const double depth = std::min(segment.width / 2, segment.half_extent);
    for (const double share : {-1.0, 0.3, 1.0})
      EXPECT_NEAR(shape.signed_distance(share * segment.half_length * segment.axis), -depth, 1e-12);
    for (int axis = 0; axis < 3; ++axis) {
      const Eigen::Vector3d unit = Eigen::Vector3d::Unit(axis);
      EXPECT_GE(2.0 * unit.dot(shape.support(unit)),
                std::min(segment.width, 2.0 * segment.half_extent) - 1e-12);
    }
  }
}

TEST(Shape, GrownShapesHoldAllWithinThePadding) {
  Random random(8);
  for (const Shape& shape : some_shapes(random)) {
    const Shape grown = shape.grown(0.03);
    double most = 0.0;
    for (int i = 0; i < 300; ++i) {
      const Eigen::Vector3d d = random.point(1.0).normalized();
      const double gain = d.dot(grown.support(d)) - d.dot(shape.support(d));
      EXPECT_GE(gain, 0.03 - 1e-12);
      most = std::max(most, gain);
    }
    EXPECT_LE(most, shape.is_rounded() ? 0.03 + 1e-12 : 0.03 * std::sqrt(3.0) + 1e-12);
    EXPECT_EQ(shape.grown(0.0).support({0.3, -0.4, 0.5}), shape.support({0.3, -0.4, 0.5}));
  }
}

TEST(Shape, CoresHoldWhatLiesDeepAndNothingElse) {
  Random random(9);
  int inside = 0, beyond = 0;
  for (const Shape& shape : some_shapes(random)) {
    double least = HUGE_VAL;  // half of the least width
    for (int i = 0; i < 2000; ++i) {
      const Eigen::Vector3d d =
          i < 3 ? Eigen::Vector3d(Eigen::Vector3d::Unit(i)) : random.point(1.0).normalized();
      least = std::min(least, 0.5 * (d.dot(shape.support(d)) - d.dot(shape.support(-d))));
    }
    for (const double depth : {0.0, 0.01, 1.0}) {
      const Shape core = shape.core(depth);
      const double by = std::min(depth, 0.49 * least);
      for (int i = 0; i < 300; ++i) {
        const Eigen::Vector3d d = random.point(1.0).normalized();
        const double gap = d.dot(shape.support(d)) - d.dot(core.support(d));
        EXPECT_GE(gap, -1e-12);
        if (shape.has_exact_distance()) {
          EXPECT_GE(gap, (shape.is_rounded() || shape.is_axial() ? 0.9 : 0.98) * by - 1e-9);
          const Eigen::Vector3d point = shape.bounding_radius() * random.point(1.0);
          const double deep = -shape.signed_distance(point), in_core = -core.signed_distance(point);
          EXPECT_TRUE(deep < depth + 1e-9 || in_core > -1e-9);
          EXPECT_TRUE(in_core < 1e-9 || deep > by - 1e-9);
          inside += in_core > 0.0;
          beyond += deep > 0.0 && in_core < 0.0;
        } else {
          EXPECT_GE(gap, std::min(depth, 0.2 * least) - 1e-9);
          // Of a hull: deep is how far a point lies behind the nearest face.
          const HullPlanes faces(shape.surface()), in_faces(core.surface());
          const double share = random.unit();
          const Eigen::Vector3d point = share * shape.support(d);
          const double deep = faces.inner_radius(point), in_core = in_faces.inner_radius(point);
          EXPECT_TRUE(deep < depth + 1e-9 || in_core > -1e-5) << deep << " " << in_core;
          EXPECT_TRUE(in_core < 0.0 || deep > std::min(depth, 0.2 * least) - 1e-5);
          inside += in_core > 0.0;
          beyond += deep > 0.0 && in_core < -1e-5;
        }
      }
    }
  }
  EXPECT_GT(inside, 300);
  EXPECT_GT(beyond, 300);
}

TEST(Shape, SizesThatNoBodyCanHaveAreRefusedByName) {
  const auto message = [](auto make) -> std::string {
    try {
      make();
    } catch (const std::invalid_argument& error) {
      return error.what();
    }
    return "accepted";
  };
  EXPECT_EQ(message([] { Shape::sphere(-0.1); }), "sphere has radius -0.1, expected a finite number above 0");
  EXPECT_EQ(message([] { Shape::capsule(0.1, NAN); }),
            "capsule has length nan, expected a finite number not below 0");
  EXPECT_EQ(message([] { Shape::cylinder(0.0, 1.0); }),
            "cylinder has radius 0, expected a finite number above 0");
  EXPECT_EQ(message([] {
              Shape::box({1.0, 0.0, 1.0});
            }),
            "box has y edge 0, expected a finite number above 0");
  EXPECT_EQ(message([] { Shape::convex({}); }), "a convex body needs at least one vertex, got none");
}

TEST(Shape, NameAndSizesMakeItAgain) {
  Random random(21);
  std::set<std::string_view> names;
  for (const Shape& shape : some_shapes(random)) {
    const std::vector<double> sizes = shape.sizes();
    if (sizes.empty()) {
      EXPECT_EQ(shape.kind(), Shape::Kind::convex);
      continue;
    }
    names.insert(shape.name());
    const Shape again = Shape::of_sizes(shape.name(), sizes);
    EXPECT_EQ(again.kind(), shape.kind());
    for (int i = 0; i < 50; ++i) {
      const Eigen::Vector3d direction = random.point(1.0);
      EXPECT_EQ(again.support(direction), shape.support(direction)) << shape.name();
    }
    EXPECT_THROW(Shape::of_sizes(shape.name(), std::vector<double>(4, 0.1)), std::invalid_argument);
  }
  EXPECT_EQ(names.size(), Shape::sized_kinds().size());
  for (const ShapeSizes& kind : Shape::sized_kinds()) EXPECT_TRUE(names.contains(kind.name)) << kind.name;
  EXPECT_THROW(Shape::of_sizes("convex", {}), std::invalid_argument);
}

/// A triangle mesh is closed, faces outwards and holds the volume when the signed tetrahedra add up to it.
TEST(Shape, TheSurfaceHoldsTheVolumeButForTheFacetsOfWhatIsRound) {
  const auto volume = [](const ShapeSurface& surface) {
    double six = 0.0;
    for (const auto& t : surface.triangles)
      six += surface.corners[static_cast<std::size_t>(t[0])].dot(
          surface.corners[static_cast<std::size_t>(t[1])].cross(
              surface.corners[static_cast<std::size_t>(t[2])]));
    return six / 6.0;
  };
  const double r = 0.2, l = 0.5, pi = std::numbers::pi;
  EXPECT_NEAR(volume(Shape::box({0.1, 0.2, 0.3}).surface()), 0.006, 1e-12);
  EXPECT_NEAR(volume(Shape::convex({{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}}).surface()), 1.0 / 6.0,
              1e-12);
  const auto share = [&](const Shape& shape, double exact) { return volume(shape.surface()) / exact; };
  const double ball = 4.0 / 3.0 * pi * r * r * r, rod = pi * r * r * l;
  for (const double found : {share(Shape::sphere(r), ball), share(Shape::capsule(r, l), ball + rod),
                             share(Shape::cylinder(r, l), rod)}) {
    EXPECT_LT(found, 1.0) << "corners lie on the surface";
    EXPECT_GT(found, 0.96);
  }
}

TEST(ConvexHull, KeepsTheCornersAndTheSupportOfFlatAndSolidPoints) {
  Random random(4);
  for (bool flat : {false, true}) {
    std::vector<Eigen::Vector3d> points;
    for (int i = 0; i < 400; ++i) points.push_back(random.point(1.0));
    if (flat) {
      for (Eigen::Vector3d& point : points) point.z() = 0.25;
    }
    const std::vector<Eigen::Vector3d> corners = hull_corners(points);
    if (!flat) {
      EXPECT_LT(corners.size(), 200u);
    }
    for (int i = 0; i < 1'000; ++i) {
      const Eigen::Vector3d direction = random.point(1.0);
      double all = -1e300, kept = -1e300;
      for (const auto& p : points) all = std::max(all, direction.dot(p));
      for (const auto& p : corners) kept = std::max(kept, direction.dot(p));
      ASSERT_NEAR(all, kept, 1e-12);
    }
  }
}

}  // namespace shape_test
}  // namespace clearway
