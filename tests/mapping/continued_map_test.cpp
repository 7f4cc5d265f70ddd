#include "mapping/continued_map.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <set>
#include <stdexcept>

#include "mapping/files/map_digest.hpp"
#include "mapping/stamps/seen_stamps.hpp"
#include "tests/worlds/random_map.hpp"

namespace clearway {
namespace continued_map_test {

using worlds::Dice;

/// One ray from a neighbouring place to a voxel, which it hits; or one that passes it.
Scan ray(const Eigen::Vector3d& from, const Eigen::Vector3d& to) {
  Scan scan;
  scan.map_from_sensor.translation() = from;
  scan.points = {(to - from).cast<float>()};
  return scan;
}

TEST(ContinuedMap, ScansChangeItAsTheyChangeTheMapThatItBeganWith) {
  for (unsigned seed = 1; seed <= 4; ++seed) {
    FreeSpaceMap map = worlds::random_map(seed);
    const Snapshot before = map.snapshot();
    const std::string digest = map_sha256(before);
    ContinuedMap continued(before, map.options());
    Dice dice(seed + 100);
    for (int i = 0; i < 5; ++i) {
      const Scan scan = worlds::random_scan(dice, 200);
      EXPECT_EQ(map.insert(scan).inserted, continued.insert(scan).inserted);
      EXPECT_EQ(map_sha256(map.snapshot()), map_sha256(continued.snapshot()));
    }
    EXPECT_NE(map_sha256(continued.snapshot()), digest);
    EXPECT_EQ(map_sha256(before), digest);
  }
}

/// From an empty map it is the map that is made with the same options: a wall 2 m away, by each margin.
TEST(ContinuedMap, KeepsTheMarginsThatItsOptionsState) {
  Scan wall;
  wall.map_from_sensor.translation() = Eigen::Vector3d::Constant(0.01);
  for (int y = -40; y <= 40; ++y)
    for (int z = -40; z <= 40; ++z)
      wall.points.emplace_back(2.0F, 0.025F * static_cast<float>(y), 0.025F * static_cast<float>(z));
  std::set<std::size_t> free;
  for (const SafeMargins& margins :
       {SafeMargins{}, SafeMargins{.band = 0.0}, SafeMargins{.band = 0.08}, SafeMargins{.sigmas = 20.0}}) {
    MapOptions options{.resolution = 0.02};
    options.margins = margins;
    FreeSpaceMap map(options);
    ContinuedMap continued(map.snapshot(), options);
    map.insert(wall);
    continued.insert(wall);
    EXPECT_EQ(map_sha256(map.snapshot()), map_sha256(continued.snapshot()));
    free.insert(continued.snapshot().counts().seen_free);
  }
  EXPECT_EQ(free.size(), 4U);
}

/// A scan from nowhere changes nothing, nor when the map was last seen: who asks how old it is is told so.
TEST(ContinuedMap, ARefusedScanIsNoLookOfAMapOrOfOneThatGoesOn) {
  Scan seen = ray(Eigen::Vector3d::Constant(0.05), Eigen::Vector3d(1.05, 0.05, 0.05)), refused = seen;
  seen.time = 2.0;
  refused.time = 100.0;
  for (const double nowhere : {std::nan(""), 1e9}) {
    refused.map_from_sensor.translation().setConstant(nowhere);
    FreeSpaceMap map({.resolution = 0.1});
    map.insert(seen);
    ContinuedMap continued(map.snapshot(), map.options());
    EXPECT_TRUE(map.insert(refused).origin_invalid);
    EXPECT_TRUE(continued.insert(refused).origin_invalid);
    for (const Snapshot& snapshot : {map.snapshot(), continued.snapshot()}) {
      ASSERT_NE(snapshot.seen(), nullptr);
      EXPECT_NEAR(snapshot.seen()->newest(), 2.0, 0.1);
      EXPECT_EQ(snapshot.counts().occupied, 1U);
    }
  }
}

TEST(ContinuedMap, FieldsThatAreBroughtUpToDateAreThoseMadeAnew) {
  FreeSpaceMap map = worlds::random_map(7);
  ContinuedMap continued(map.snapshot(), map.options());
  const Eigen::AlignedBox3d region(Eigen::Vector3d::Constant(-1.0), Eigen::Vector3d::Constant(1.0));
  Dice dice(8);
  for (int i = 0; i < 4; ++i) {
    continued.insert(worlds::random_scan(dice, 100));
    const Snapshot now = continued.snapshot();
    const Snapshot anew(std::shared_ptr<const FusedTree>(std::shared_ptr<const FusedTree>(), &now.tree()),
                        now.volumes());
    for (const Policy policy : {Policy::painted, Policy::known_free, Policy::not_occupied}) {
      const auto updated = now.blocked_space({policy}, region, 0.3);
      const auto made = anew.blocked_space({policy}, region, 0.3);
      for (int k = 0; k < 500; ++k) {
        const Eigen::Vector3d point = dice.point(1.0);
        EXPECT_EQ(updated->clearance(point), made->clearance(point));
      }
    }
  }
}

TEST(ContinuedMap, AHitInPaintIsAConflictUntilMissesTakeItBack) {
  FreeSpaceMap map({.resolution = 0.1});
  map.paint(map.add_volume("free", {}), {Eigen::Vector3d(0.05, 0.05, 0.05), 0.5});
  const Eigen::Vector3d voxel(0.25, 0.05, 0.05), sensor(-1.95, 0.05, 0.05), beyond(3.05, 0.05, 0.05);
  ContinuedMap continued(map.snapshot(), {.hit_probability = 0.9});
  EXPECT_EQ(continued.snapshot().state(voxel), VoxelState::painted);
  continued.insert(ray(sensor, voxel));
  EXPECT_EQ(continued.snapshot().state(voxel), VoxelState::conflict);
  for (int i = 0; i < 6; ++i) continued.insert(ray(sensor, beyond));
  EXPECT_EQ(continued.snapshot().state(voxel), VoxelState::painted);
}

TEST(ContinuedMap, TheFirstHitCountsWhereTheMapWasSeenFreeForLong) {
  for (const double least_free : {0.3, 0.1192, 0.01}) {
    FreeSpaceMap map({.resolution = 0.1, .min_probability = least_free});
    const Eigen::Vector3d voxel(0.25, 0.05, 0.05), sensor(-1.95, 0.05, 0.05), beyond(3.05, 0.05, 0.05);
    for (int i = 0; i < 40; ++i) map.insert(ray(sensor, beyond));
    const double hit = decisive_hit_probability(map.snapshot(), 0.7);
    EXPECT_GE(hit, 0.7);
    ContinuedMap continued(map.snapshot(), {.hit_probability = hit});
    EXPECT_EQ(continued.snapshot().state(voxel), VoxelState::seen_free);
    continued.insert(ray(sensor, voxel));
    EXPECT_EQ(continued.snapshot().state(voxel), VoxelState::occupied) << least_free;
  }
}

TEST(ContinuedMap, TheFirstHitOutlastsAsManyMissesAsAreNamed) {
  FreeSpaceMap map({.resolution = 0.1});
  const Eigen::Vector3d voxel(0.25, 0.05, 0.05), sensor(-1.95, 0.05, 0.05), beyond(3.05, 0.05, 0.05);
  for (int i = 0; i < 5; ++i) map.insert(ray(sensor, beyond));
  for (const int misses : {1, 3}) {
    ContinuedMap continued(map.snapshot(),
                           {.hit_probability = decisive_hit_probability(map.snapshot(), 0.5, misses),
                            .integration = Integration::compatible});
    continued.insert(ray(sensor, voxel));
    for (int i = 0; i < misses; ++i) {
      continued.insert(ray(sensor, beyond));
      EXPECT_EQ(continued.snapshot().state(voxel), VoxelState::occupied) << i << " of " << misses;
    }
    continued.insert(ray(sensor, beyond));
    EXPECT_EQ(continued.snapshot().state(voxel), VoxelState::seen_free) << misses;
  }
}

TEST(ContinuedMap, ProbabilitiesOutOfRangeAreRefusedByName) {
  try {
    ContinuedMap(Snapshot(), {.hit_probability = 0.4});
    FAIL();
  } catch (const std::invalid_argument& error) {
    EXPECT_EQ(std::string(error.what()),
              "map option hit_probability is 0.4, expected a value in [0.5, 0.999999]");
  }
  EXPECT_THROW(ContinuedMap(Snapshot(), {.miss_probability = 0.0}), std::invalid_argument);
  for (const int threads : {-1, 0, 65, 2147483647})
    EXPECT_THROW(ContinuedMap(Snapshot(), {.threads = threads}), std::invalid_argument) << threads;
  for (const double band : {-1.0, std::nan("")})
    EXPECT_THROW(ContinuedMap(Snapshot(), {.margins = {.band = band}}), std::invalid_argument) << band;
}

TEST(ContinuedMap, OneThatWasMovedFromSaysSo) {
  ContinuedMap map(Snapshot(), {});
  const ContinuedMap other(std::move(map));
  EXPECT_THROW(map.insert(ray({0, 0, 0}, {1, 0, 0})), std::logic_error);
  EXPECT_THROW(map.snapshot(), std::logic_error);
}

}  // namespace continued_map_test
}  // namespace clearway
