#include "apps/problem_sets/solid_cells.hpp"

#include <gtest/gtest.h>

#include "apps/suites/suite_cells.hpp"
#include "mapping/voxels/triangle_cells.hpp"
#include "tests/worlds/random_world.hpp"

namespace clearway {
namespace solid_cells_test {

TEST(SolidCells, ATriangleMeetsACubeWhenAPointOfItIsInsideAndNeverWhenGjkHoldsThemApart) {
  Random random(1);
  int met = 0;
  for (int round = 0; round < 1000; ++round) {
    const Eigen::Vector3d a = random.point(1.0), b = random.point(1.0), c = random.point(1.0);
    const Eigen::Vector3d center = random.point(1.0);
    const double edge = random.between(0.02, 0.8);
    const bool meets = triangle_meets_box({a, b, c}, center, Eigen::Vector3d::Constant(0.5 * edge));
    met += meets;
    bool has_inside = false;
    for (int i = 0; i <= 60 && !has_inside; ++i) {
      for (int k = 0; i + k <= 60 && !has_inside; ++k) {
        const Eigen::Vector3d point = a + i / 60.0 * (b - a) + k / 60.0 * (c - a);
        has_inside = (point - center).lpNorm<Eigen::Infinity>() < 0.5 * edge;
      }
    }
    EXPECT_FALSE(has_inside && !meets) << round;
    const Shape hull = Shape::convex({a, b, c});
    const DistanceBounds apart = distance_to_cube(hull, Eigen::Isometry3d::Identity(), center, edge);
    EXPECT_LT(meets ? apart.lower : 0.0, 1e-7) << round;
    EXPECT_GT(meets ? 1.0 : apart.upper, 0.0) << round;
  }
  EXPECT_GT(met, 40);
  EXPECT_LT(met, 960);
}

TEST(SolidCells, ACubeThatIsOnlyTouchedIsMet) {
  const Eigen::Vector3d a(0, 0, 0.1), b(1, 0, 0.1), c(0, 1, 0.1);
  const Eigen::Vector3d half = Eigen::Vector3d::Constant(0.05);
  EXPECT_TRUE(triangle_meets_box({a, b, c}, {0.05, 0.05, 0.05}, half));
  EXPECT_FALSE(triangle_meets_box({a, b, c}, {0.05, 0.05, 0.04}, half));
}

TEST(SolidCells, AMeshIsItsSurfaceAndASolidIsFull) {
  // A cube of 1 m from twelve triangles: its surface, and the box of the same size.
  std::vector<Eigen::Vector3d> corners;
  for (int axis = 0; axis < 3; ++axis) {
    for (const double side : {0.05, 1.05}) {
      Eigen::Vector3d p[4];
      for (int i = 0; i < 4; ++i) {
        p[i][axis] = side;
        p[i][(axis + 1) % 3] = 0.05 + (i == 1 || i == 2);
        p[i][(axis + 2) % 3] = 0.05 + (i >= 2);
      }
      for (const int i : {0, 1, 2, 0, 2, 3}) corners.push_back(p[i]);
    }
  }
  ForeignWorld world{"w", {}};
  ForeignSolid& mesh = world.solids.emplace_back();
  mesh.triangles = corners;
  std::vector<std::size_t> cells;
  const Snapshot surface = map_of_foreign_world(world, 0.1, cells);
  ForeignWorld full{"w", {}};
  ForeignSolid& box = full.solids.emplace_back();
  box.shape = Shape::box({1, 1, 1});
  box.map_from_shape.translation().setConstant(0.55);
  const Snapshot solid = map_of_foreign_world(full, 0.1, cells);
  EXPECT_EQ(solid.counts().occupied, 11U * 11U * 11U);
  EXPECT_EQ(surface.counts().occupied, 11U * 11U * 11U - 9U * 9U * 9U);
  EXPECT_EQ(surface.state({0.55, 0.55, 0.55}), VoxelState::unknown);
  EXPECT_EQ(surface.state({0.05, 0.55, 0.55}), VoxelState::occupied);
}

TEST(SolidCells, AConeIsHeldByItsPyramidAndHardlyMore) {
  const Shape cone = cone_shape(0.3, 0.8);
  Random random(3);
  for (int i = 0; i < 2000; ++i) {
    const double height = random.unit(), angle = random.between(0.0, 6.3), part = random.unit();
    const Eigen::Vector3d point(part * 0.3 * (1 - height) * std::cos(angle),
                                part * 0.3 * (1 - height) * std::sin(angle), -0.4 + 0.8 * height);
    const Eigen::Vector3d direction = random.point(1.0);
    EXPECT_LE(direction.dot(point), direction.dot(cone.support(direction)) + 1e-12);
  }
  for (const Eigen::Vector3d& corner : cone.vertices()) EXPECT_LT(corner.head<2>().norm(), 0.3 * 1.0013);
}

}  // namespace solid_cells_test
}  // namespace clearway
