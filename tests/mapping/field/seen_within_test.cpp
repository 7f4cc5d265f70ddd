#include "mapping/field/seen_within.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "mapping/field/blocked_field.hpp"
#include "mapping/files/map_file.hpp"
#include "mapping/maps/map_edit.hpp"
#include "mapping/stamps/seen_stamps.hpp"
#include "mapping/voxels/fused_tree.hpp"
#include "tests/worlds/random_map.hpp"
#include "tests/worlds/temporary_folder.hpp"

namespace clearway {
namespace seen_within_test {

using worlds::Dice;

constexpr double edge = 0.05;
const Eigen::AlignedBox3d region(Eigen::Vector3d(-0.8, -0.9, -0.7), Eigen::Vector3d(0.85, 0.7, 0.9));

/// A scan of a random part of the shell, at a time.
Scan partial_scan(Dice& dice, double time) {
  Scan scan = worlds::random_scan(dice, 400);
  const Eigen::Vector3f towards = dice.point(1.0).normalized().cast<float>();
  std::erase_if(scan.points, [&](const Eigen::Vector3f& point) { return point.dot(towards) < 0.2F; });
  scan.time = time;
  return scan;
}

/// What a requirement with a time forbids, voxel by voxel.
bool is_forbidden(const Snapshot& map, const Requirement& requirement, const Eigen::Vector3d& center) {
  const Voxel voxel = map.voxel(center);
  if (!allows(requirement, voxel.state, voxel.volumes)) return true;
  if (requirement.seen_within == 0.0 || requirement.policy != Policy::known_free ||
      voxel.state != VoxelState::seen_free)
    return false;
  const auto seen = map.last_seen(center);
  return !seen || map.seen()->newest() - *seen > requirement.seen_within;
}

TEST(SeenWithin, BlockedSpacesAgeFromSnapshotToSnapshotVoxelByVoxel) {
  Dice dice(1);
  FreeSpaceMap map({.resolution = edge, .threads = 2, .integration = Integration::compatible});
  map.add_volume("tunnel", {"tool"});
  std::size_t stale = 0, fresh = 0;
  std::vector<std::pair<Snapshot, std::shared_ptr<const BlockedSpace>>> kept;
  for (int round = 0; round < 25; ++round) {
    // Sometimes time passes although nothing is seen anew but one far voxel.
    if (round % 5 == 4) {
      Scan far;
      far.time = round;
      far.points = {{0.9F, 0.9F, 0.9F}};
      map.insert(far);
    } else {
      map.insert(partial_scan(dice, round));
    }
    if (round % 3 == 0) map.paint(0, {dice.point(0.6), 0.2});
    const Snapshot now = map.snapshot();
    for (const Requirement& requirement :
         {Requirement{Policy::known_free, 0xffff, 3.0}, Requirement{Policy::known_free, 0xffff, 10.0},
          Requirement{Policy::known_free}, Requirement{Policy::painted, 1}}) {
      const auto space = now.blocked_space(requirement, region, 0.3);
      const auto& field = dynamic_cast<const BlockedField&>(*space);
      std::size_t blocked = 0;
      for (int z = 0; z < field.cells().size.z(); ++z) {
        for (int y = 0; y < field.cells().size.y(); ++y) {
          for (int x = 0; x < field.cells().size.x(); ++x) {
            const Eigen::Vector3i cell = field.cells().first + Eigen::Vector3i(x, y, z);
            const Eigen::Vector3d center = (cell.cast<double>().array() + 0.5) * edge;
            const bool forbidden = is_forbidden(now, requirement, center);
            ASSERT_EQ(space->is_voxel_blocked(cell), forbidden) << round;
            ASSERT_EQ(space->is_blocked(center), forbidden) << round;
            ASSERT_EQ(space->clearance(center) <= 0.0, forbidden) << round;
            blocked += forbidden ? 1U : 0U;
            if (requirement.seen_within == 3.0 && now.state(center) == VoxelState::seen_free)
              ++(forbidden ? stale : fresh);
          }
        }
      }
      ASSERT_EQ(space->blocked_count(), blocked);
      // The same from nothing, distances and all.
      const BlockedField anew(now.tree(), requirement, field.cells(), now.seen());
      for (int i = 0; i < 200; ++i) {
        const Eigen::Vector3d point = dice.point(0.8);
        ASSERT_EQ(space->clearance(point), anew.clearance(point));
        const Eigen::Vector3d way = dice.point(1.0).normalized();
        ASSERT_EQ(space->cast_ray(point, way, 1.0).distance, anew.cast_ray(point, way, 1.0).distance);
      }
      if (requirement.seen_within == 3.0 && requirement.policy == Policy::known_free)
        kept.emplace_back(now, space);
    }
  }
  EXPECT_GT(stale, 1000U);
  EXPECT_GT(fresh, 1000U);
  for (const auto& [then, space] : kept)  // a snapshot goes on saying what it said
    ASSERT_EQ(then.blocked_space({Policy::known_free, 0xffff, 3.0}, region, 0.3), space);
}

TEST(SeenWithin, PaintDoesNotAgeAndWhatBlocksStaysBlocked) {
  FreeSpaceMap map({.resolution = edge});
  const int volume = map.add_volume("tunnel", {});
  Scan scan;
  for (int i = -20; i <= 20; ++i) scan.points.push_back({1.0F, 0.05F * static_cast<float>(i), 0.025F});
  map.insert(scan);
  map.paint(volume, {{0.5, 0.0, 0.0}, 0.15});
  Scan later;
  later.time = 100.0;
  later.points = {{-1.0F, 0.0F, 0.0F}};
  map.insert(later);
  const Snapshot now = map.snapshot();
  const auto ever = now.blocked_space({Policy::known_free}, now.bounds(), 0.3);
  const auto lately = now.blocked_space({Policy::known_free, 0xffff, 5.0}, now.bounds(), 0.3);
  const Eigen::Vector3d painted(0.5, 0.0, 0.025), seen(0.8, 0.0, 0.025), wall(1.01, 0.0, 0.025);
  EXPECT_FALSE(lately->is_blocked(painted));
  EXPECT_FALSE(ever->is_blocked(seen));
  EXPECT_TRUE(lately->is_blocked(seen));
  EXPECT_TRUE(lately->is_blocked(wall));
  EXPECT_EQ(now.last_seen(seen), 0.0);
  EXPECT_EQ(now.last_seen({0.0, 5.0, 0.0}), std::nullopt);
  EXPECT_EQ(now.seen()->newest(), 100.0);
}

TEST(SeenWithin, AMapKeepsItsAgesInItsFileAndInItsEdits) {
  Dice dice(2);
  FreeSpaceMap map({.resolution = edge}), other({.resolution = edge});
  for (int round = 0; round < 8; ++round) {
    map.insert(partial_scan(dice, 10.0 * round));
    other.insert(partial_scan(dice, 10.0 * round + 5));
  }
  const TemporaryFolder folder;
  const Snapshot now = map.snapshot();
  save_map(now, folder / "map");
  const Eigen::AlignedBox3d box(Eigen::Vector3d(-0.4, -0.4, -0.4), Eigen::Vector3d(0.4, 0.4, 0.4));
  const Snapshot read = load_map(folder / "map"), alone = load_map(folder / "map/map.ot"),
                 part = crop(read, box);
  const Snapshot theirs = other.snapshot(), both = merge(read, theirs), coarse = coarsen(read, 2 * edge);
  ASSERT_NE(read.seen(), nullptr);
  ASSERT_NE(alone.seen(), nullptr);
  std::size_t seen = 0;
  for (int i = 0; i < 5000; ++i) {
    const Eigen::Vector3d point = dice.point(1.0);
    const auto last = now.last_seen(point);
    seen += last ? 1 : 0;
    ASSERT_EQ(read.last_seen(point), last);
    ASSERT_EQ(alone.last_seen(point), last);
    if (box.contains(point)) {
      ASSERT_EQ(part.last_seen(point), last);
    }
    ASSERT_EQ(both.last_seen(point), std::max(last, theirs.last_seen(point)));
    if (const auto oldest = coarse.last_seen(point)) {
      ASSERT_TRUE(last && *oldest <= *last);
    }
  }
  EXPECT_GT(seen, 300U);
  EXPECT_EQ(part.seen()->newest(), now.seen()->newest());
  export_map(now, folder / "map.bt");
  EXPECT_EQ(load_map(folder / "map.bt").seen(), nullptr);
}

TEST(SeenWithin, AnAgeUnderAPolicyThatAsksForNoneIsRefused) {
  FreeSpaceMap map({.resolution = edge});
  Dice dice(3);
  for (const double time : {0.0, 1.0}) {
    Scan scan = worlds::random_scan(dice, 20);
    scan.time = time;
    map.insert(scan);
  }
  const Snapshot snapshot = map.snapshot();
  for (const Policy policy : {Policy::painted, Policy::not_occupied}) {
    EXPECT_NO_THROW(snapshot.blocked_space({policy, 0xffff, 0.0}, region, 0.3));
    try {
      snapshot.blocked_space({policy, 0xffff, 5.0}, region, 0.3);
      ADD_FAILURE() << to_string(policy);
    } catch (const std::invalid_argument& error) {
      EXPECT_EQ(
          std::string(error.what()),
          "seen within: only the policy known_free asks when a voxel was seen, expected it or no age, got "
          "the policy " +
              std::string(to_string(policy)));
    }
  }
}

TEST(SeenWithin, WhatAMapCannotAnswerIsRefusedByName) {
  const auto refusal = [](double seconds, const SeenStamps* seen) -> std::string {
    try {
      require_seen_within(seconds, seen);
    } catch (const std::invalid_argument& error) {
      return error.what();
    }
    return "";
  };
  FreeSpaceMap map({.resolution = edge});
  Dice dice(3);
  EXPECT_EQ(map.snapshot().seen(), nullptr);
  Scan scan = worlds::random_scan(dice, 20);
  scan.time = std::numeric_limits<double>::quiet_NaN();
  map.insert(scan);
  EXPECT_EQ(map.snapshot().seen(), nullptr);
  EXPECT_NE(refusal(5.0, nullptr).find("does not know when its voxels were seen"), std::string::npos);
  EXPECT_THROW(map.snapshot().blocked_space({Policy::known_free, 0xffff, 5.0}, region, 0.3),
               std::invalid_argument);
  EXPECT_EQ(refusal(0.0, nullptr), "");
  for (const double time : {0.0, 1e5}) {
    scan.time = time;
    map.insert(scan);
  }
  EXPECT_NE(refusal(0.5, map.snapshot().seen()).find("knows times to 2 s"), std::string::npos);
  EXPECT_EQ(refusal(2.0, map.snapshot().seen()), "");
  for (const double none : {-1.0, HUGE_VAL, std::nan("")})
    EXPECT_NE(refusal(none, map.snapshot().seen()).find("finite time not below 0"), std::string::npos);
}

}  // namespace seen_within_test
}  // namespace clearway
