#include "mapping/maps/freed_voxels.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "mapping/maps/map_difference.hpp"
#include "mapping/stamps/seen_stamps.hpp"
#include "mapping/voxels/fused_tree.hpp"
#include "tests/worlds/voxel_scene.hpp"

namespace clearway {
namespace freed_voxels_test {

/// A block of 8 x 8 x 8 occupied voxels, half of it painted over.
Snapshot block() {
  VoxelScene scene{0.05, {box_of(0.0, 0.0, 0.0, 0.4, 0.4, 0.4)}, {{{0.0, 0.2, 0.2}, 0.3}}, {"tool"}};
  return scene.snapshot();
}

TEST(FreedVoxels, ChangeWhatIsAskedAndNothingElse) {
  const Snapshot map = block();
  const std::vector<Eigen::Vector3d> points = {{0.026, 0.024, 0.031}, {0.375, 0.375, 0.375}, {2.0, 2.0, 2.0}};
  for (const bool is_painted : {false, true}) {
    const Snapshot freed = with_free_voxels(map, points, is_painted);
    EXPECT_EQ(freed.state(points[0]), VoxelState::painted);  // it was a conflict
    EXPECT_EQ(freed.state(points[1]), is_painted ? VoxelState::painted : VoxelState::seen_free);
    EXPECT_EQ(freed.state(points[2]), is_painted ? VoxelState::painted : VoxelState::seen_free);
    const MapDifference changes = difference(map, freed);
    std::size_t changed = 0;
    for (const auto& [states, voxels] : changes.states) changed += voxels;
    EXPECT_EQ(changed, 3U);
    EXPECT_TRUE(changes.volumes.empty());
    EXPECT_EQ(freed.volumes().size(), map.volumes().size());
  }
  EXPECT_EQ(map.state(points[0]), VoxelState::conflict);
  EXPECT_EQ(map.state(points[1]), VoxelState::occupied);
  EXPECT_EQ(map.state(points[2]), VoxelState::unknown);
}

TEST(FreedVoxels, AreInEveryVolumeWhereTheyArePaintedAndTheMapKnowsItsTimesAsBefore) {
  FreeSpaceMap builder({.resolution = 0.05});
  Scan scan;
  scan.time = 3.0;
  scan.map_from_sensor.translation().setConstant(0.025);
  scan.points = {{1.0F, 0.0F, 0.0F}};
  builder.insert(scan);
  const Snapshot map = builder.snapshot();
  const Eigen::Vector3d hit(1.025, 0.025, 0.025), seen(0.525, 0.025, 0.025), never(0.0, 2.0, 0.0);
  for (const bool is_painted : {false, true}) {
    const Snapshot freed = with_free_voxels(map, {hit, never}, is_painted);
    for (const Eigen::Vector3d& point : {hit, never})
      EXPECT_EQ(freed.voxel(point).volumes, is_painted ? 0x7fff : 0);  // all 15
    ASSERT_NE(freed.seen(), nullptr);
    EXPECT_EQ(freed.last_seen(seen), map.last_seen(seen));
    EXPECT_EQ(freed.seen()->newest(), map.seen()->newest());
  }
}

TEST(FreedVoxels, AllOfThemOneByOneAreTheWholeOfThem) {
  const Snapshot map = block();
  std::vector<Eigen::Vector3d> all;
  for (int i = 0; i < 512; ++i)
    all.emplace_back(0.05 * (i % 8 + 0.5), 0.05 * (i / 8 % 8 + 0.5), 0.05 * (i / 64 + 0.5));
  Snapshot one_by_one = map;
  for (const Eigen::Vector3d& point : all) one_by_one = with_free_voxels(one_by_one, {point}, false);
  const Snapshot at_once = with_free_voxels(map, all, false);
  EXPECT_FALSE(difference(at_once, one_by_one).any());
  EXPECT_EQ(at_once.counts().occupied + at_once.counts().conflict, 0U);
}

TEST(FreedVoxels, WhatHasNoVoxelIsLeftOut) {
  const Snapshot map = block();
  const double nan = std::numeric_limits<double>::quiet_NaN();
  const Snapshot freed = with_free_voxels(map, {{nan, 0.0, 0.0}, {1e9, 0.0, 0.0}}, true);
  EXPECT_FALSE(difference(map, freed).any());
}

/// The fields that a snapshot takes over from the map before agree with those made anew.
TEST(FreedVoxels, BlockedSpacesFollow) {
  const Snapshot map = block();
  const Eigen::AlignedBox3d region = box_of(-0.5, -0.5, -0.5, 0.9, 0.9, 0.9);
  for (const Policy policy : {Policy::painted, Policy::known_free, Policy::not_occupied}) {
    const Requirement requirement{.policy = policy};
    map.blocked_space(requirement, region, 0.3);
    const Snapshot freed = with_free_voxels(map, {{0.225, 0.225, 0.225}, {0.375, 0.375, 0.375}}, true);
    const auto space = freed.blocked_space(requirement, region, 0.3);
    const auto anew = Snapshot(std::make_shared<FusedTree>(freed.tree()), freed.volumes())
                          .blocked_space(requirement, region, 0.3);
    for (double x = -0.475; x < 0.9; x += 0.05)
      for (double y = -0.475; y < 0.9; y += 0.05)
        for (double z = -0.475; z < 0.9; z += 0.05) {
          const Eigen::Vector3d point(x, y, z);
          ASSERT_EQ(space->is_blocked(point), anew->is_blocked(point)) << point.transpose();
          ASSERT_EQ(space->clearance(point), anew->clearance(point)) << point.transpose();
        }
  }
}

}  // namespace freed_voxels_test
}  // namespace clearway
