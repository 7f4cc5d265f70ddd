// Bodies in painted volumes: the voxel test against projections onto every cube near, and against the exact
// union of spheres.

#include "mapping/volumes/painted_body.hpp"

#include <gtest/gtest.h>

#include "mapping/volumes/body_cube.hpp"
#include "mapping/voxels/fused_tree.hpp"
#include "tests/worlds/random_map.hpp"
#include "tests/worlds/trials.hpp"

namespace clearway {
namespace painted_body_test {

using worlds::Dice;

struct Body {
  Eigen::Vector3d a, b;
  double radius;
  int kind;  ///< 0 sphere, 1 capsule, 2 cylinder

  /// The body's point that is nearest to `p`.
  Eigen::Vector3d project(const Eigen::Vector3d& p) const {
    const Eigen::Vector3d axis = kind == 0 ? Eigen::Vector3d(0, 0, 0) : Eigen::Vector3d((b - a).normalized());
    const double along = (p - a).dot(axis);
    const double kept = std::clamp(along, 0.0, kind == 0 ? 0.0 : (b - a).norm());
    const Eigen::Vector3d off =
        kind == 2 ? Eigen::Vector3d(p - a - along * axis) : Eigen::Vector3d(p - a - kept * axis);
    return a + kept * axis + off * std::min(1.0, radius / std::max(off.norm(), 1e-300));
  }
};

bool contains(const PaintedSpace& space, const Body& body) {
  if (body.kind == 0) return space.contains(Sphere{body.a, body.radius});
  if (body.kind == 1) return space.contains(Capsule{body.a, body.b, body.radius});
  return space.contains(Cylinder{body.a, body.b, body.radius});
}

Containment in_union(const std::vector<Sphere>& spheres, const Body& body, double tolerance) {
  if (body.kind == 2) return union_contains(spheres, Cylinder{body.a, body.b, body.radius}, tolerance);
  return union_contains(spheres, Capsule{body.a, body.kind == 0 ? body.a : body.b, body.radius}, tolerance);
}

Body random_body(Dice& dice, const std::vector<Sphere>& spheres) {
  const Sphere& sphere =
      spheres[static_cast<std::size_t>(dice.whole(0, static_cast<int>(spheres.size()) - 1))];
  Body body{sphere.center + dice.point(0.7 * sphere.radius),
            {},
            sphere.radius * dice.uniform(0.02, 0.6),
            dice.whole(0, 2)};
  body.b = body.a + dice.point(1.2 * sphere.radius);
  return body;
}

/// Distance between a body and a cube by projecting to and fro; both are convex.
double distance_by_projections(const Body& body, const Eigen::AlignedBox3d& cube) {
  Eigen::Vector3d p = cube.center();
  double gap = 0.0;
  for (int i = 0; i < 3000; ++i) {
    const Eigen::Vector3d q = body.project(p);
    p = q.cwiseMax(cube.min()).cwiseMin(cube.max());
    gap = (p - q).norm();
    if (gap < 1e-9) break;
  }
  return gap;
}

TEST(BodyCube, DistancesAreThoseOfProjections) {
  Dice dice(5);
  for (int trial = 0; trial < 400; ++trial) {
    const Eigen::Vector3d low = dice.point(0.5);
    const Eigen::AlignedBox3d box(low, low + Eigen::Vector3d::Constant(dice.uniform(0.05, 0.5)));
    const Eigen::Vector3d a = dice.point(1.0), b = dice.whole(0, 9) == 0 ? a : dice.point(1.0);
    const double truth = distance_by_projections({a, b, 1e-12, a == b ? 0 : 1}, box);
    EXPECT_NEAR(std::sqrt(segment_box_squared(a, b, box)), truth, 1e-5);
    if (a == b) continue;
    const double axis = axis_distance_between_ends({a, b, 0.1}, box);
    if (axis < 10.0) {
      EXPECT_LT(distance_by_projections({a, b, 1.05 * axis + 0.02, 2}, box), 1e-4);
    }
    if (axis > 0.05 && axis < 10.0) {
      EXPECT_GT(distance_by_projections({a, b, 0.9 * axis, 2}, box), 1e-3);
    }
    if (axis == HUGE_VAL) {
      EXPECT_GT(distance_by_projections({a, b, 10.0, 2}, box), 0.0);
    }
  }
}

TEST(PaintedSpace, HoldsABodyExactlyWhenNoBlockedCubeMeetsIt) {
  for (int seed = 0; seed < trials(1, 3); ++seed) {
    Dice dice(50 + static_cast<unsigned>(seed));
    FreeSpaceMap painted({.resolution = 0.06});
    painted.add_volume("v", {});
    for (int i = 0; i < 20; ++i) painted.paint(0, {dice.point(0.4), dice.uniform(0.1, 0.3)});
    painted.insert(worlds::random_scan(dice, 10));
    const Snapshot map = painted.snapshot();
    const PaintedSpace space(map, 1);
    int held = 0, tight = 0;
    for (int trial = 0; trial < 150; ++trial) {
      const Body body = random_body(dice, map.volumes()[0].spheres);
      double nearest = HUGE_VAL;
      const Eigen::Vector3d reach = Eigen::Vector3d::Constant(body.radius + 0.06);
      const Eigen::Vector3d end = body.kind == 0 ? body.a : body.b;
      const Eigen::Array3d low = (body.a.cwiseMin(end) - reach).array(),
                           high = (body.a.cwiseMax(end) + reach).array();
      for (double x = std::floor(low.x() / 0.06); x * 0.06 < high.x(); ++x) {
        for (double y = std::floor(low.y() / 0.06); y * 0.06 < high.y(); ++y) {
          for (double z = std::floor(low.z() / 0.06); z * 0.06 < high.z(); ++z) {
            const Eigen::Vector3d corner = Eigen::Vector3d(x, y, z) * 0.06;
            const Eigen::AlignedBox3d cube(corner, corner + Eigen::Vector3d::Constant(0.06));
            const Voxel voxel = map.voxel(cube.center());
            if (allows({Policy::painted, 1}, voxel.state, voxel.volumes) || nearest < 1e-6) continue;
            nearest = std::min(nearest, distance_by_projections(body, cube));
          }
        }
      }
      if (nearest > 1e-8 && nearest < 1e-4) continue;  // projections come no nearer in a while
      ASSERT_EQ(contains(space, body), nearest >= 1e-4) << trial << " " << nearest;
      held += nearest >= 1e-4 ? 1 : 0;
      tight += nearest < 0.01 ? 1 : 0;
    }
    EXPECT_GT(held, 10);
    EXPECT_GT(tight, 10);
  }
}

TEST(PaintedSpace, NeverHoldsWhatTheUnionOfSpheresDoesNot) {
  Dice dice(8);
  int held = 0, inside = 0;
  for (const double resolution : {0.08, 0.03}) {
    FreeSpaceMap map({.resolution = resolution});
    map.add_volume("v", {});
    std::vector<Sphere> spheres;
    for (int i = 0; i < 25; ++i) spheres.push_back({dice.point(0.5), dice.uniform(0.1, 0.35)});
    for (const Sphere& sphere : spheres) map.paint(0, sphere);
    const PaintedSpace space(map.snapshot(), 1);
    for (int trial = 0; trial < 3000; ++trial) {
      const Body body = random_body(dice, spheres);
      const Containment truth = in_union(spheres, body, 1e-3);
      inside += truth == Containment::inside ? 1 : 0;
      if (!contains(space, body)) continue;
      ++held;
      ASSERT_EQ(truth == Containment::inside ? truth : in_union(spheres, body, 1e-6), Containment::inside);
    }
  }
  EXPECT_GT(held, 1000);
  EXPECT_GT(inside, held);
}

TEST(PaintedSpace, AVoxelThatIsSensedOccupiedKeepsBodiesOut) {
  FreeSpaceMap map({.resolution = 0.05});
  map.add_volume("v", {});
  map.paint(0, {{0, 0, 0}, 0.5});
  EXPECT_TRUE(PaintedSpace(map.snapshot(), 1).contains(Sphere{{0, 0, 0}, 0.3}));
  EXPECT_FALSE(PaintedSpace(map.snapshot(), 2).contains(Sphere{{0, 0, 0}, 0.3}));
  Scan scan;
  scan.points = {{0.12F, 0.02F, 0.02F}};
  map.insert(scan);
  const PaintedSpace space(map.snapshot(), 1);
  EXPECT_FALSE(space.contains(Sphere{{0, 0, 0}, 0.3}));
  EXPECT_FALSE(space.contains(Capsule{{0, -0.2, 0}, {0.08, 0.2, 0}, 0.1}));
  EXPECT_TRUE(space.contains(Cylinder{{-0.01, 0, 0}, {-0.2, 0, 0}, 0.2}));
}

TEST(PaintedSpace, HoldsABodyInALonePaintedCubeOfVoxelsWhereverThatLies) {
  FusedNode painted;
  painted.add_paint(1);
  for (const double resolution : {0.01, 0.03, 0.05, 0.06, 0.1}) {
    for (int k = -24; k < 24; ++k) {  // borders of voxels are no round numbers: each is rounded its own way
      const int edge = 1 << ((k + 24) % 4);
      const Eigen::Vector3i corner = edge * Eigen::Vector3i(k, -k, 3 * k);
      const auto tree = std::make_shared<FusedTree>(resolution);
      tree->set_leaf({corner, edge}, painted);
      tree->finish();
      const PaintedSpace space(Snapshot(tree, {}), 1);
      const double half = 0.5 * edge * resolution;
      const Eigen::Vector3d middle = (corner.cast<double>() * resolution).array() + half;
      ASSERT_TRUE(space.contains(Sphere{middle, 0.999 * half})) << k << " of " << resolution;
      ASSERT_FALSE(space.contains(Sphere{middle, 1.001 * half})) << k << " of " << resolution;
      for (int axis = 0; axis < 3; ++axis) {
        for (const double side : {-1.0, 1.0}) {
          const Eigen::Vector3d face = middle + side * half * Eigen::Vector3d::Unit(axis);
          ASSERT_TRUE(space.contains(Capsule{middle, middle + 0.98 * (face - middle), 0.01 * half}));
          ASSERT_FALSE(space.contains(Capsule{middle, face, 0.01 * half}));
        }
      }
    }
  }
}

TEST(PaintedSpace, NothingIsInsideWhereNothingIsPaintedAndABodyMustBeOne) {
  const PaintedSpace space(Snapshot(), 1);
  EXPECT_FALSE(space.contains(Sphere{{0, 0, 0}, 0.1}));
  EXPECT_THROW(space.contains(Sphere{{0, 0, 0}, 0.0}), std::invalid_argument);
  EXPECT_THROW(space.contains(Cylinder{{0, 0, 0}, {0, 0, std::nan("")}, 0.1}), std::invalid_argument);
  const double nan = std::nan("");
  for (const Capsule& none : {Capsule{{0, nan, 0}, {0, 0, 1}, 0.1}, Capsule{{0, 0, 0}, {nan, 0, 1}, 0.1},
                              Capsule{{0, 0, 0}, {0, 0, 1}, HUGE_VAL}, Capsule{{0, 0, 0}, {0, 0, 1}, nan},
                              Capsule{{0, 0, 0}, {0, 0, 1}, 0.0}})
    EXPECT_THROW(union_contains({}, none, 0.1), std::invalid_argument);
  EXPECT_THROW(union_contains({}, Capsule{{0, 0, 0}, {0, 0, 1}, 0.1}, 0.0), std::invalid_argument);
}

/// A ball that a larger one leaves bare on one side, whichever that is.
TEST(UnionContains, FindsABarePartOnEachSide) {
  const Body ball{{0.31, -0.12, 0.07}, {}, 0.1, 0};
  for (int x = -1; x <= 1; ++x)
    for (int y = -1; y <= 1; ++y)
      for (int z = -1; z <= 1; ++z) {
        if (x == 0 && y == 0 && z == 0) continue;
        const Eigen::Vector3d way = Eigen::Vector3d(x, y, z).normalized();
        const Sphere larger{ball.a + 0.03 * way, 0.12}, patch{ball.a - 0.09 * way, 0.1};
        EXPECT_EQ(in_union({larger}, ball, 1e-4), Containment::outside) << way.transpose();
        EXPECT_EQ(in_union({larger, patch}, ball, 1e-4), Containment::inside) << way.transpose();
      }
}

TEST(UnionContains, AgreesWithFormulas) {
  const std::vector<Sphere> one{{{0, 0, 0}, 1.0}};
  // A cylinder about the centre fits when its rim does: (l / 2)^2 + r^2 <= 1.
  EXPECT_EQ(union_contains(one, Cylinder{{0, 0, -0.599}, {0, 0, 0.599}, 0.799}, 1e-4), Containment::inside);
  EXPECT_EQ(union_contains(one, Cylinder{{0, 0, -0.601}, {0, 0, 0.601}, 0.801}, 1e-4), Containment::outside);
  EXPECT_EQ(union_contains(one, Capsule{{0, 0, -0.5}, {0, 0, 0.5}, 0.499}, 1e-4), Containment::inside);
  EXPECT_EQ(union_contains(one, Capsule{{0, 0, -0.5}, {0, 0, 0.5}, 0.501}, 1e-4), Containment::outside);
  EXPECT_EQ(union_contains(one, Capsule{{0, 0, -0.5}, {0, 0, 0.5}, 0.5}, 1e-3), Containment::undecided);
  // A rod through two spheres fits through the circle in which they meet.
  const std::vector<Sphere> two{{{0, 0, 0}, 1.0}, {{1.2, 0, 0}, 1.0}};
  EXPECT_EQ(union_contains(two, Cylinder{{-0.3, 0, 0}, {1.5, 0, 0}, 0.79}, 1e-4), Containment::inside);
  EXPECT_EQ(union_contains(two, Cylinder{{-0.3, 0, 0}, {1.5, 0, 0}, 0.81}, 1e-4), Containment::outside);
  EXPECT_EQ(union_contains({}, Capsule{{0, 0, 0}, {0, 0, 0}, 0.1}, 1e-3), Containment::outside);
}

/// By arithmetic, in a ball of 0.5 m: a capsule from its middle lies in it where length and radius together
/// are less, a cylinder where the diagonal is.
TEST(PaintedBody, WhatBeginsInABallsMiddleIsInItAsFarAsItsEndReaches) {
  constexpr double edge = 0.02, ball = 0.5, voxel = 0.04;  // as much may be missing or more
  FreeSpaceMap map({.resolution = edge});
  map.add_volume("all", {"tool"});
  map.paint(0, {Eigen::Vector3d::Zero(), ball});
  const PaintedSpace space(map.snapshot(), 1);
  int inside = 0, outside = 0;
  for (const Eigen::Vector3d& way :
       {Eigen::Vector3d(1, 0, 0), Eigen::Vector3d(0, -1, 0), Eigen::Vector3d(1.0 / 3, 2.0 / 3, -2.0 / 3)})
    for (const double radius : {0.1, 0.2, 0.3, 0.4})
      for (double length = 0.02; length < 0.6; length += 0.02) {
        const Eigen::Vector3d none = Eigen::Vector3d::Zero(), end = length * way;
        const double capsule = length + radius, cylinder = std::hypot(length, radius);
        const bool holds_capsule = space.contains(Capsule{none, end, radius}),
                   holds_cylinder = space.contains(Cylinder{none, end, radius});
        EXPECT_EQ(holds_capsule, space.contains(Capsule{end, none, radius}));
        if (capsule < ball - voxel || capsule > ball) {
          EXPECT_EQ(holds_capsule, capsule < ball) << length << ' ' << radius;
          ++(holds_capsule ? inside : outside);
        }
        if (cylinder < ball - voxel || cylinder > ball) {
          EXPECT_EQ(holds_cylinder, cylinder < ball) << length << ' ' << radius;
        }
      }
  EXPECT_GT(inside, 50);
  EXPECT_GT(outside, 50);
}

}  // namespace painted_body_test
}  // namespace clearway
