// Painting against brute force: every voxel near a sphere, its eight corners one by one.

#include <gtest/gtest.h>

#include <map>

#include "mapping/free_space_map.hpp"
#include "mapping/voxels/fused_tree.hpp"
#include "tests/worlds/random_map.hpp"

namespace clearway {
namespace paint_sphere_test {

using worlds::Dice;

bool corners_inside(const Eigen::Vector3i& cell, double resolution, const Sphere& sphere) {
  for (int corner = 0; corner < 8; ++corner) {
    const Eigen::Vector3i at = cell + Eigen::Vector3i(corner & 1, (corner >> 1) & 1, (corner >> 2) & 1);
    if ((at.cast<double>() * resolution - sphere.center).norm() > sphere.radius) return false;
  }
  return true;
}

/// Inner nodes agree with their children, and none has eight equal leaves.
void expect_settled(const FusedNode& node) {
  if (!node.has_children()) return;
  FusedNode* const copy = new FusedNode(node);
  copy->updateOccupancyChildren();
  EXPECT_TRUE(*copy == node);
  std::size_t nodes = 8;
  EXPECT_FALSE(copy->prune(nodes));
  FusedNode::release(copy);
  for (unsigned i = 0; i < 8; ++i) {
    if (node.child(i) != nullptr) expect_settled(*node.child(i));
  }
}

TEST(Painting, PaintsExactlyTheVoxelsWhollyInsideASphere) {
  Dice dice(7);
  for (int trial = 0; trial < 40; ++trial) {
    const double resolution = dice.uniform(0.02, 0.1);
    FreeSpaceMap map({.resolution = resolution});
    map.add_volume("v", {});
    const Sphere sphere{dice.point(0.7), dice.uniform(0.01, 0.4)};
    const PaintCounts counts = map.paint(0, sphere);
    const Snapshot snapshot = map.snapshot();
    std::size_t expected = 0;
    const int reach = static_cast<int>(std::ceil(1.2 / resolution));
    for (int x = -reach; x < reach; ++x) {
      for (int y = -reach; y < reach; ++y) {
        for (int z = -reach; z < reach; ++z) {
          const Eigen::Vector3d center = (Eigen::Vector3d(x, y, z).array() + 0.5) * resolution;
          if ((center - sphere.center).norm() > sphere.radius) continue;
          const bool inside = corners_inside({x, y, z}, resolution, sphere);
          expected += inside ? 1 : 0;
          ASSERT_EQ(snapshot.state(center), inside ? VoxelState::painted : VoxelState::unknown);
        }
      }
    }
    EXPECT_EQ(counts.painted, expected);
    EXPECT_EQ(counts.newly, expected);
    EXPECT_EQ(snapshot.counts().painted, expected);
  }
}

TEST(Painting, NoPaintedVoxelReachesOutsideTheUnionOfSpheres) {
  const Snapshot snapshot = worlds::random_map(11, 0.04, 10).snapshot();
  std::size_t painted = 0;
  snapshot.visit_leaves([&](const Voxel& voxel) {
    if (voxel.volumes == 0) return;
    ++painted;
    for (std::size_t v = 0; v < snapshot.volumes().size(); ++v) {
      if ((voxel.volumes >> v & 1U) == 0) continue;
      for (int corner = 0; corner < 8; ++corner) {
        const Eigen::Vector3d half =
            Eigen::Vector3d(corner & 1 ? 1 : -1, corner & 2 ? 1 : -1, corner & 4 ? 1 : -1) *
            (voxel.size / 2 * (1 - 1e-9));
        ASSERT_TRUE(snapshot.volumes()[v].contains(voxel.center + half));
      }
    }
  });
  EXPECT_GT(painted, 100U);
}

TEST(Painting, ASphereMakesTheTreeThatItsVoxelsMakeOneByOne) {
  for (unsigned seed = 0; seed < 15; ++seed) {
    Dice dice(seed);
    constexpr double resolution = 0.05;
    FreeSpaceMap whole({.resolution = resolution}), single({.resolution = resolution});
    for (FreeSpaceMap* map : {&whole, &single}) {
      map->add_volume("a", {});
      map->add_volume("b", {});
    }
    for (int step = 0; step < 12; ++step) {
      const int volume = dice.whole(0, 1);
      const Sphere sphere = worlds::random_sphere(dice);
      const Snapshot before = whole.snapshot();  // some nodes are shared, as when a reader looks on
      PaintCounts sum;
      const PaintCounts counts = whole.paint(volume, sphere);
      for (int x = -24; x < 24; ++x) {
        for (int y = -24; y < 24; ++y) {
          for (int z = -24; z < 24; ++z) {
            if (!corners_inside({x, y, z}, resolution, sphere)) continue;
            // About the voxel's middle, just large enough for it alone.
            const PaintCounts one = single.paint(
                volume, {(Eigen::Vector3d(x, y, z).array() + 0.5) * resolution, resolution * 0.8661});
            sum.painted += one.painted;
            sum.newly += one.newly;
            sum.conflicts += one.conflicts;
          }
        }
      }
      EXPECT_EQ(counts.painted, sum.painted);
      EXPECT_EQ(counts.newly, sum.newly);
      EXPECT_EQ(counts.conflicts, sum.conflicts);
      const Snapshot now = whole.snapshot();
      ASSERT_TRUE(now.tree() == single.snapshot().tree());
      ASSERT_EQ(now.tree().size(), now.tree().calcNumNodes());
      if (now.tree().getRoot() != nullptr) expect_settled(*now.tree().getRoot());
      if (step % 3 != 0) continue;
      const Scan scan = worlds::random_scan(dice, 100);
      whole.insert(scan);
      single.insert(scan);
    }
  }
}

TEST(Painting, CountsTheVoxelsOfSpheresWhoseSurfacesPassThroughTheirCorners) {
  constexpr int eighths = 2;  // a voxel's edge is a quarter of a metre: all numbers below are exact
  for (const Eigen::Vector3i& center : {Eigen::Vector3i(0, 0, 0), Eigen::Vector3i(2, -4, 6),
                                        Eigen::Vector3i(1, 0, -3), Eigen::Vector3i(5, 5, 5)}) {
    for (int radius = 1; radius <= 26; ++radius) {
      std::size_t expected = 0;
      for (int x = -18; x < 18; ++x) {
        for (int y = -18; y < 18; ++y) {
          for (int z = -18; z < 18; ++z) {
            const Eigen::Array3i low = (eighths * Eigen::Vector3i(x, y, z) - center).array();
            const Eigen::Array3i far = low.abs().max((low + eighths).abs());
            expected += far.square().sum() <= radius * radius ? 1 : 0;
          }
        }
      }
      FreeSpaceMap map({.resolution = 0.25});
      map.add_volume("v", {});
      const PaintCounts counts = map.paint(0, {center.cast<double>() / 8.0, radius / 8.0});
      EXPECT_EQ(counts.painted, expected) << "radius " << radius;
      EXPECT_EQ(counts.newly, expected) << "radius " << radius;
      EXPECT_EQ(map.snapshot().counts().painted, expected) << "radius " << radius;
    }
  }
}

TEST(Painting, LooksThroughASolidObstacleAgainAndAgainWithoutSplittingIt) {
  FreeSpaceMap map({.resolution = 0.1});
  map.add_volume("v", {});
  Scan scan;
  for (int i = 0; i < 64; ++i)
    scan.points.emplace_back(0.85F + 0.1F * (i % 4), 0.05F + 0.1F * (i / 4 % 4), 0.05F + 0.1F * (i / 16));
  map.insert(scan);
  const Sphere sphere{{0.8, 0.2, 0.2}, 0.3};
  const PaintCounts first = map.paint(0, sphere);
  EXPECT_GT(first.conflicts, 8U);
  EXPECT_LT(first.conflicts, 32U);
  map.paint(0, {{1.0, 0.2, 0.2}, 2.0});  // all of the obstacle: one leaf again
  const Snapshot before = map.snapshot();
  CellCube cube;
  ASSERT_NE(before.tree().find_leaf({9, 1, 1}, cube), nullptr);
  EXPECT_EQ(cube.edge, 4);
  const PaintCounts again = map.paint(0, sphere);
  EXPECT_EQ(again.conflicts, first.conflicts);
  EXPECT_EQ(again.newly, 0U);
  const Snapshot after = map.snapshot();
  EXPECT_TRUE(after.tree() == before.tree());
  EXPECT_EQ(after.tree().size(), after.tree().calcNumNodes());
}

TEST(Painting, RepaintingIsCountedButChangesNothing) {
  FreeSpaceMap map({.resolution = 0.05});
  map.add_volume("v", {});
  const Sphere sphere{{0.1, 0.2, 0.3}, 0.3};
  const PaintCounts first = map.paint(0, sphere);
  const FusedTree before(map.snapshot().tree());
  const PaintCounts again = map.paint(0, sphere);
  EXPECT_EQ(again.painted, first.painted);
  EXPECT_EQ(again.newly, 0U);
  EXPECT_TRUE(before == map.snapshot().tree());
}

TEST(Painting, OrderOfSpheresAndScansDoesNotMatterToTheVoxels) {
  for (unsigned seed = 0; seed < 10; ++seed) {
    Dice dice(seed);
    std::vector<Sphere> spheres;
    for (int i = 0; i < 6; ++i) spheres.push_back(worlds::random_sphere(dice));
    const Scan scan = worlds::random_scan(dice, 300);
    FreeSpaceMap paint_first({.resolution = 0.05}), scan_first({.resolution = 0.05});
    paint_first.add_volume("v", {});
    scan_first.add_volume("v", {});
    for (const Sphere& sphere : spheres) paint_first.paint(0, sphere);
    paint_first.insert(scan);
    scan_first.insert(scan);
    for (auto sphere = spheres.rbegin(); sphere != spheres.rend(); ++sphere) scan_first.paint(0, *sphere);
    EXPECT_TRUE(paint_first.snapshot().tree() == scan_first.snapshot().tree());
  }
}

TEST(Painting, NeverChangesWhatSensorsSay) {
  for (unsigned seed = 0; seed < 20; ++seed) {
    Dice dice(seed);
    FreeSpaceMap painted({.resolution = 0.06}), twin({.resolution = 0.06});
    painted.add_volume("a", {});
    painted.add_volume("b", {});
    for (int step = 0; step < 12; ++step) {
      for (int i = dice.whole(0, 3); i > 0; --i) painted.paint(dice.whole(0, 1), worlds::random_sphere(dice));
      const Scan scan = worlds::random_scan(dice, 60);
      painted.insert(scan);
      twin.insert(scan);
    }
    const Snapshot with = painted.snapshot(), without = twin.snapshot();
    std::size_t observed = 0;
    with.tree().visit_leaves([&](const FusedNode& node, const CellCube& cube) {
      for (int i = 0; i < cube.edge * cube.edge * cube.edge; ++i) {
        const Eigen::Vector3i cell = cube.corner + Eigen::Vector3i(i % cube.edge, i / cube.edge % cube.edge,
                                                                   i / cube.edge / cube.edge);
        CellCube twin_cube;
        const FusedNode* other = without.tree().find_leaf(cell, twin_cube);
        ASSERT_EQ(node.observed(), other != nullptr);
        if (other == nullptr) continue;
        ++observed;
        ASSERT_EQ(node.getLogOdds(), other->getLogOdds());
      }
    });
    const VoxelCounts counts = without.counts();
    EXPECT_EQ(observed, counts.occupied + counts.seen_free);
  }
}

TEST(Painting, CountsConflictsAndKeepsThemBlocked) {
  FreeSpaceMap map({.resolution = 0.1});
  map.add_volume("v", {});
  Scan scan;
  scan.points = {{0.55F, 0.05F, 0.05F}};
  map.insert(scan);
  const PaintCounts counts = map.paint(0, {{0.55, 0.05, 0.05}, 0.2});
  EXPECT_EQ(counts.conflicts, 1U);
  const Snapshot snapshot = map.snapshot();
  EXPECT_EQ(snapshot.state({0.55, 0.05, 0.05}), VoxelState::conflict);
  EXPECT_EQ(snapshot.counts().conflict, 1U);
  for (const Policy policy : {Policy::painted, Policy::known_free, Policy::not_occupied}) {
    EXPECT_FALSE(allows({policy}, VoxelState::conflict, 1));
  }
}

TEST(Painting, ASphereBeyondTheReachOfTheTreePaintsOnlyWhatTheTreeHolds) {
  FreeSpaceMap map({.resolution = 0.001});  // reaches 32.768 m
  map.add_volume("v", {});
  EXPECT_EQ(map.paint(0, {{100.0, 0.0, 0.0}, 0.1}).painted, 0U);
  EXPECT_GT(map.paint(0, {{32.768, 0.0005, 0.0005}, 0.01}).painted, 0U);
  FusedTree tree(0.001);
  EXPECT_EQ(tree.paint(0, {{0.0, 0.0, 0.0}, 1e6}).painted, std::size_t{1} << 48U);
}

TEST(Painting, RefusesWhatIsNoSphereOrNoVolume) {
  FreeSpaceMap map;
  map.add_volume("v", {});
  const Eigen::Vector3d origin = Eigen::Vector3d::Zero();
  EXPECT_THROW(map.paint(1, {origin, 0.1}), std::invalid_argument);
  EXPECT_THROW(map.paint(-1, {origin, 0.1}), std::invalid_argument);
  for (const double radius : {0.0, -1.0, HUGE_VAL, std::nan("")}) {
    EXPECT_THROW(map.paint(0, {origin, radius}), std::invalid_argument);
  }
  EXPECT_THROW(map.paint(0, {{0.0, std::nan(""), 0.0}, 0.1}), std::invalid_argument);
  EXPECT_TRUE(map.volumes()[0].spheres.empty());
}

}  // namespace paint_sphere_test
}  // namespace clearway
