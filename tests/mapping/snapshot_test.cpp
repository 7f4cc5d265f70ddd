#include "mapping/snapshot.hpp"

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <limits>
#include <random>
#include <set>
#include <thread>

#include "mapping/free_space_map.hpp"
#include "mapping/voxels/fused_tree.hpp"
#include "tests/worlds/random_map.hpp"

namespace clearway {
namespace snapshot_test {

using worlds::box_around;

/// One ray along x from the origin's voxel that ends at 0.55 m, and paint around 0.35 to 0.75 m.
FreeSpaceMap corridor() {
  FreeSpaceMap map({.resolution = 0.1, .integration = Integration::compatible});
  map.add_volume("paint", {"tool"});
  Scan scan;
  scan.map_from_sensor.translation() = Eigen::Vector3d::Constant(0.05);
  scan.points = {{0.5F, 0.0F, 0.0F}, {0.0F, 0.5F, 0.0F}};
  map.insert(scan);
  map.paint(0, {{0.55, 0.05, 0.05}, 0.3});
  return map;
}

TEST(Snapshot, ReportsEveryStateOfTheTable) {
  const Snapshot map = corridor().snapshot();
  EXPECT_EQ(map.state({0.15, 0.05, 0.05}), VoxelState::seen_free);
  EXPECT_EQ(map.state({0.05, 0.55, 0.05}), VoxelState::occupied);
  EXPECT_EQ(map.state({0.55, 0.05, 0.05}), VoxelState::conflict);
  EXPECT_EQ(map.state({0.45, 0.05, 0.05}), VoxelState::painted);  // also seen free
  EXPECT_EQ(map.state({0.65, 0.05, 0.05}), VoxelState::painted);  // never seen
  EXPECT_EQ(map.state({0.05, 0.05, 0.35}), VoxelState::unknown);
  EXPECT_TRUE(map.voxel({0.45, 0.05, 0.05}).observed);
  EXPECT_FALSE(map.voxel({0.65, 0.05, 0.05}).observed);
  EXPECT_EQ(map.voxel({0.65, 0.05, 0.05}).volumes, 1);
}

TEST(Snapshot, KnowsWhetherItHoldsAState) {
  const FreeSpaceMap empty({.resolution = 0.1});
  EXPECT_FALSE(empty.snapshot().holds_any({VoxelState::painted, VoxelState::occupied}));
  const Snapshot map = corridor().snapshot();
  for (const VoxelState state :
       {VoxelState::seen_free, VoxelState::occupied, VoxelState::conflict, VoxelState::painted})
    EXPECT_TRUE(map.holds_any({state})) << to_string(state);
  FreeSpaceMap painted({.resolution = 0.1});
  painted.add_volume("paint", {"tool"});
  painted.paint(0, {{0.55, 0.05, 0.05}, 0.3});
  EXPECT_TRUE(painted.snapshot().holds_any({VoxelState::occupied, VoxelState::painted}));
  EXPECT_FALSE(
      painted.snapshot().holds_any({VoxelState::occupied, VoxelState::conflict, VoxelState::seen_free}));
}

TEST(Snapshot, AnswersUnknownFarAwayAndForNoPointAtAll) {
  const Snapshot map = corridor().snapshot();
  for (const double bad : {std::nan(""), HUGE_VAL, 1e9, -1e300}) {
    EXPECT_EQ(map.state({bad, 0.0, 0.0}), VoxelState::unknown);
  }
  const Voxel voxel = map.voxel({2.03, 0.0, 0.0});
  EXPECT_EQ(voxel.state, VoxelState::unknown);
  EXPECT_TRUE(voxel.center.isApprox(Eigen::Vector3d(2.05, 0.05, 0.05)));
  EXPECT_EQ(voxel.size, 0.1);
}

TEST(Snapshot, CountsPrunedLeavesAsTheirVoxels) {
  for (unsigned seed = 0; seed < 5; ++seed) {
    const Snapshot map = worlds::random_map(seed, 0.08, 6).snapshot();
    const VoxelCounts counts = map.counts();
    VoxelCounts expected;
    for (double x = -1.96; x < 2.0; x += 0.08) {
      for (double y = -1.96; y < 2.0; y += 0.08) {
        for (double z = -1.96; z < 2.0; z += 0.08) {
          switch (map.state({x, y, z})) {
            case VoxelState::painted:
              ++expected.painted;
              break;
            case VoxelState::seen_free:
              ++expected.seen_free;
              break;
            case VoxelState::occupied:
              ++expected.occupied;
              break;
            case VoxelState::conflict:
              ++expected.conflict;
              break;
            case VoxelState::unknown:
              break;
          }
        }
      }
    }
    EXPECT_EQ(counts.painted, expected.painted);
    EXPECT_EQ(counts.seen_free, expected.seen_free);
    EXPECT_EQ(counts.occupied, expected.occupied);
    EXPECT_EQ(counts.conflict, expected.conflict);
  }
}

TEST(Snapshot, BoundsHoldAllLeavesAndAnEmptyMapHasNone) {
  EXPECT_TRUE(Snapshot().bounds().isEmpty());
  const Snapshot map = corridor().snapshot();
  EXPECT_TRUE(map.bounds().min().isApprox(Eigen::Vector3d(0.0, -0.2, -0.2), 1e-9))
      << map.bounds().min().transpose();
  EXPECT_TRUE(map.bounds().max().isApprox(Eigen::Vector3d(0.8, 0.6, 0.3), 1e-9))
      << map.bounds().max().transpose();
}

TEST(Snapshot, BoundsAreThoseOfAllStoredLeaves) {
  for (unsigned seed = 0; seed < 6; ++seed) {
    const Snapshot map = worlds::random_map(seed, 0.05).snapshot();
    Eigen::AlignedBox3i cells;
    map.tree().visit_leaves([&](const FusedNode&, const CellCube& cube) {
      cells.extend(cube.corner);
      cells.extend(cube.corner + Eigen::Vector3i::Constant(cube.edge));
    });
    const Eigen::AlignedBox3d bounds = map.bounds();
    EXPECT_EQ(bounds.min(), Eigen::Vector3d(cells.min().cast<double>() * map.resolution()));
    EXPECT_EQ(bounds.max(), Eigen::Vector3d(cells.max().cast<double>() * map.resolution()));
  }
}

TEST(Snapshot, VisitedLeavesAnswerAsTheirPointsDo) {
  const Snapshot map = worlds::random_map(9).snapshot();
  std::size_t leaves = 0;
  map.visit_leaves([&](const Voxel& leaf) {
    ++leaves;
    const Voxel voxel = map.voxel(leaf.center);
    EXPECT_EQ(voxel.state, leaf.state);
    EXPECT_EQ(voxel.volumes, leaf.volumes);
    EXPECT_EQ(voxel.size, leaf.size);
    EXPECT_EQ(voxel.center, leaf.center);
  });
  EXPECT_EQ(leaves, map.tree().getNumLeafNodes());
}

TEST(Snapshot, LeavesOfABoxAreAllThatMeetItAndNoneAVoxelAway) {
  std::mt19937 random(4);
  std::uniform_real_distribution<double> place(-3.0, 3.0), side(0.0, 1.0);
  for (unsigned seed = 0; seed < 4; ++seed) {
    const Snapshot map = worlds::random_map(seed, 0.05).snapshot();
    for (int trial = 0; trial < 50; ++trial) {
      const Eigen::Vector3d corner(place(random), place(random), place(random));
      Eigen::AlignedBox3d box(corner, corner + Eigen::Vector3d(side(random), side(random), side(random)));
      if (trial % 5 == 1) box.min().x() = -HUGE_VAL;
      if (trial % 5 == 2) box.max().y() = std::numeric_limits<double>::quiet_NaN();
      const Eigen::Vector3d grown = Eigen::Vector3d::Constant((1.0 + 1e-9) * map.resolution());
      const auto meets = [](const Voxel& leaf, const Eigen::Vector3d& low, const Eigen::Vector3d& high) {
        const Eigen::Vector3d half = Eigen::Vector3d::Constant(leaf.size / 2);
        return !((leaf.center + half).array() < low.array()).any() &&
               !((leaf.center - half).array() > high.array()).any();
      };
      std::set<std::array<double, 3>> visited;
      map.visit_leaves(box, [&](const Voxel& leaf) {
        visited.insert({leaf.center.x(), leaf.center.y(), leaf.center.z()});
        EXPECT_TRUE(meets(leaf, box.min() - grown, box.max() + grown));
      });
      map.visit_leaves([&](const Voxel& leaf) {
        const bool is_visited = visited.contains({leaf.center.x(), leaf.center.y(), leaf.center.z()});
        EXPECT_TRUE(is_visited || !meets(leaf, box.min(), box.max()));
      });
    }
    int leaves = 0;
    const auto count = [&](const Voxel&) { ++leaves; };
    map.visit_leaves(Eigen::AlignedBox3d(), count);
    map.visit_leaves({Eigen::Vector3d::Constant(1e9), Eigen::Vector3d::Constant(2e9)}, count);
    EXPECT_EQ(leaves, 0);
  }
}

TEST(Snapshot, FindsTheVolumesOfACriticalPart) {
  FreeSpaceMap map;
  map.add_volume("a", {"tool", "load"});
  map.add_volume("b", {"elbow"});
  map.add_volume("c", {"tool"});
  const Snapshot snapshot = map.snapshot();
  EXPECT_EQ(snapshot.volumes_of_part("tool"), 5);
  EXPECT_EQ(snapshot.volumes_of_part("elbow"), 2);
  EXPECT_EQ(snapshot.volumes_of_part("base"), 0);
}

TEST(Snapshot, SharesABlockedSpaceThatWasBuiltForTheSameArguments) {
  const Snapshot map = corridor().snapshot();
  const Snapshot copy = map;
  const auto space = map.blocked_space({Policy::painted}, box_around(0.5), 0.3);
  EXPECT_EQ(copy.blocked_space({Policy::painted}, box_around(0.5), 0.3), space);
  EXPECT_NE(map.blocked_space({Policy::painted, 1}, box_around(0.5), 0.3), space);
  EXPECT_NE(map.blocked_space({Policy::known_free}, box_around(0.5), 0.3), space);
  EXPECT_NE(map.blocked_space({Policy::painted}, box_around(0.6), 0.3), space);
  EXPECT_NE(map.blocked_space({Policy::painted}, box_around(0.5), 0.31), space);
}

TEST(Snapshot, BlockedSpacesOfALaterSnapshotAreThoseOfItsOwnTree) {
  FreeSpaceMap map = worlds::random_map(6);
  worlds::Dice dice(12);
  std::size_t compared = 0;
  for (int i = 0; i < 8; ++i) {
    const Snapshot snapshot = map.snapshot();
    const Snapshot alone(std::make_shared<const FusedTree>(snapshot.tree()), snapshot.volumes());
    for (const Policy policy : {Policy::painted, Policy::known_free, Policy::not_occupied}) {
      if (i == 3 && policy == Policy::painted) continue;  // this one is asked for again two versions later
      const auto updated = snapshot.blocked_space({policy, 1}, box_around(0.8), 0.4);
      const auto built = alone.blocked_space({policy, 1}, box_around(0.8), 0.4);
      EXPECT_EQ(updated->blocked_count(), built->blocked_count());
      for (int k = 0; k < 500; ++k, ++compared) {
        const Eigen::Vector3d point = dice.point(0.9);
        ASSERT_EQ(updated->clearance(point), built->clearance(point));
        ASSERT_EQ(updated->is_blocked(point), built->is_blocked(point));
      }
    }
    if (i % 2 == 0) map.insert(worlds::random_scan(dice, 100));
    if (i % 2 == 1) map.paint(0, worlds::random_sphere(dice));
  }
  EXPECT_GT(compared, 10000U);
}

TEST(Snapshot, WhatWasMovedFromIsStillTheMap) {
  Snapshot snapshot = worlds::random_map(4).snapshot();
  const std::size_t painted = snapshot.counts().painted;
  const Snapshot moved = std::move(snapshot);
  EXPECT_GT(painted, 0U);
  EXPECT_EQ(snapshot.counts().painted, painted);
  EXPECT_EQ(&snapshot.tree(), &moved.tree());
  Snapshot assigned;
  assigned = std::move(snapshot);
  EXPECT_EQ(&snapshot.tree(), &assigned.tree());
}

TEST(Snapshot, IsReadFromManyThreadsWhileTheMapIsWritten) {
  FreeSpaceMap map = worlds::random_map(4);
  const Snapshot snapshot = map.snapshot();
  std::vector<std::shared_ptr<const BlockedSpace>> spaces(4);
  std::vector<double> sums(4, 0.0);
  std::vector<std::thread> readers;
  for (std::size_t i = 0; i < spaces.size(); ++i) {
    readers.emplace_back([&, i] {
      spaces[i] = snapshot.blocked_space({Policy::known_free}, box_around(1.0), 0.5);
      worlds::Dice dice(1);
      for (int k = 0; k < 5000; ++k) {
        const Eigen::Vector3d point = dice.point(1.0);
        sums[i] += spaces[i]->clearance(point) + snapshot.voxel(point).log_odds;
      }
    });
  }
  worlds::Dice dice(8);
  for (int k = 0; k < 5; ++k) map.insert(worlds::random_scan(dice, 100));
  for (std::thread& reader : readers) reader.join();
  for (std::size_t i = 1; i < spaces.size(); ++i) {
    EXPECT_EQ(spaces[i], spaces[0]);
    EXPECT_EQ(sums[i], sums[0]);
  }
}

}  // namespace snapshot_test
}  // namespace clearway
