#include "mapping/free_space_map.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <functional>

#include "tests/worlds/random_map.hpp"

namespace clearway {
namespace free_space_map_test {

std::string refusal(const MapOptions& options) {
  try {
    const FreeSpaceMap map(options);
  } catch (const std::invalid_argument& error) {
    return error.what();
  }
  return "";
}

TEST(FreeSpaceMap, NamesTheOptionThatIsOutOfRange) {
  for (const double bad : {0.0, -0.1, 1e-5, 101.0, std::nan(""), HUGE_VAL}) {
    EXPECT_NE(refusal({.resolution = bad}).find("resolution"), std::string::npos) << bad;
  }
  EXPECT_NE(refusal({.hit_probability = 0.4}).find("hit_probability"), std::string::npos);
  EXPECT_NE(refusal({.miss_probability = 0.6}).find("miss_probability"), std::string::npos);
  EXPECT_NE(refusal({.min_probability = 0.5}).find("min_probability"), std::string::npos);
  EXPECT_NE(refusal({.max_probability = 1.0}).find("max_probability"), std::string::npos);
  EXPECT_NE(refusal({.occupied_probability = 0.99}).find("occupied_probability"), std::string::npos);
}

TEST(FreeSpaceMap, HoldsFifteenVolumesWithLabelsOfTheirOwn) {
  FreeSpaceMap map;
  for (int i = 0; i < 15; ++i) EXPECT_EQ(map.add_volume("volume " + std::to_string(i), {}), i);
  EXPECT_THROW(map.add_volume("one more", {}), std::invalid_argument);
  FreeSpaceMap other;
  other.add_volume("same", {});
  EXPECT_THROW(other.add_volume("same", {}), std::invalid_argument);
  EXPECT_THROW(other.add_volume("two\nlines", {}), std::invalid_argument);
  EXPECT_THROW(other.add_volume("fine", {"bell\a"}), std::invalid_argument);
  EXPECT_THROW(other.add_volume("fine", {"tool", ""}), std::invalid_argument);
}

TEST(FreeSpaceMap, EveryVolumePaintsItsOwnBit) {
  FreeSpaceMap map({.resolution = 0.1});
  for (int i = 0; i < 15; ++i) {
    map.add_volume(std::to_string(i), {});
    map.paint(i, {{0.1 * i + 0.05, 0.05, 0.05}, 0.09});
  }
  const Snapshot snapshot = map.snapshot();
  for (int i = 0; i < 15; ++i) EXPECT_EQ(snapshot.voxel({0.1 * i + 0.05, 0.05, 0.05}).volumes, 1U << i);
}

TEST(FreeSpaceMap, RefusesABallOfMoreThanAThousandVoxelsAndStaysAsItWas) {
  FreeSpaceMap map({.resolution = 0.02});
  map.add_volume("a", {});
  map.begin_stroke("millimetres");
  EXPECT_THROW(map.paint(0, {{0, 0, 0}, 20.01}), std::invalid_argument);
  EXPECT_TRUE(map.volumes()[0].spheres.empty());
  EXPECT_TRUE(map.snapshot().bounds().isEmpty());
  EXPECT_GT(map.paint(0, {{0, 0, 0}, 0.1}).painted, 0U);
  EXPECT_EQ(map.erase(0, {{0, 0, 0}, 40.0}).removed, 1U);  // an eraser may be as large as it likes
}

TEST(FreeSpaceMap, UndoEndsAnOpenStrokeAlsoWhereNothingIsUndone) {
  FreeSpaceMap map({.resolution = 0.05});
  map.add_volume("a", {});
  map.begin_stroke("empty");
  EXPECT_EQ(map.undo_stroke(), -1);
  map.paint(0, {{0, 0, 0}, 0.2});  // of no stroke: no undo takes it away
  EXPECT_EQ(map.undo_stroke(), -1);
  EXPECT_EQ(map.volumes()[0].spheres.size(), 1U);
}

TEST(FreeSpaceMap, PaintsNothingWhereItHasNoVoxels) {
  FreeSpaceMap map({.resolution = 0.05});
  map.add_volume("a", {});
  for (const double away : {1e4, 1e9, 1e17, 1e300}) {
    EXPECT_EQ(map.paint(0, {{away, 0, -away}, 0.5}).painted, 0U);
    EXPECT_EQ(map.paint(0, {{0, -away, 0}, 40.0}).painted, 0U);
  }
}

TEST(FreeSpaceMap, KeepsTheExactSpheresInTheOrderPainted) {
  FreeSpaceMap map;
  map.add_volume("v", {"tool"});
  map.paint(0, {{0.1, 0.2, 0.3}, 0.05}, 1.5);
  map.paint(0, {{0.4, 0.5, 0.6}, 0.07}, 2.5);
  const PaintedVolume& volume = map.volumes()[0];
  ASSERT_EQ(volume.spheres.size(), 2U);
  EXPECT_EQ(volume.spheres[1].center, Eigen::Vector3d(0.4, 0.5, 0.6));
  EXPECT_EQ(volume.times, (std::vector<double>{1.5, 2.5}));
  EXPECT_TRUE(volume.contains({0.1, 0.2, 0.35}));
  EXPECT_FALSE(volume.contains({0.1, 0.2, 0.3501}));
}

TEST(FreeSpaceMap, ASnapshotStaysAsItWasWhileTheMapGoesOn) {
  FreeSpaceMap map = worlds::random_map(2);
  const Snapshot before = map.snapshot();
  const VoxelCounts counts = before.counts();
  worlds::Dice dice(3);
  map.insert(worlds::random_scan(dice, 500));
  map.paint(0, {{0.0, 0.0, 0.0}, 0.5});
  EXPECT_EQ(before.counts().painted, counts.painted);
  EXPECT_EQ(before.counts().seen_free, counts.seen_free);
  EXPECT_GT(map.snapshot().counts().painted, counts.painted);
}

TEST(FreeSpaceMap, WhatWasMovedFromSaysSoAndMayBeAssignedTo) {
  FreeSpaceMap map = worlds::random_map(2);
  const FreeSpaceMap moved = std::move(map);
  for (const std::function<void()>& call : std::vector<std::function<void()>>{
           [&] { map.add_volume("v", {}); },
           [&] {
             map.paint(0, {{0, 0, 0}, 1});
           },
           [&] {
             map.erase(0, {{0, 0, 0}, 1});
           },
           [&] { map.begin_stroke("s"); }, [&] { map.end_stroke(); }, [&] { map.undo_stroke(); },
           [&] { map.undo_stroke(0); }, [&] { map.keep_scans(); }, [&] { map.conflicts(); },
           [&] { map.provenance(); }, [&] { map.note_damaged_recording(1); }, [&] { map.insert({}); },
           [&] { map.options(); }, [&] { map.volumes(); }, [&] { map.snapshot(); }})
    EXPECT_THROW(call(), std::logic_error);
  EXPECT_GT(moved.snapshot().counts().painted, 0U);
  map = FreeSpaceMap({.resolution = 0.25});
  EXPECT_EQ(map.snapshot().resolution(), 0.25);
}

TEST(FreeSpaceMap, AHigherThresholdCallsTheSameEvidenceFreeUnlessWhatIsHitIsBlockedAtOnce) {
  Scan scan;
  scan.points = {{0.55F, 0.05F, 0.05F}};
  for (const double threshold : {0.5, 0.69, 0.71}) {
    for (const Integration integration : {Integration::compatible, Integration::safe}) {
      FreeSpaceMap map({.resolution = 0.1, .occupied_probability = threshold, .integration = integration});
      map.insert(scan);
      const bool is_enough = threshold < 0.7 || integration == Integration::safe;  // one hit gives 0.7
      const VoxelState expected = is_enough ? VoxelState::occupied : VoxelState::seen_free;
      EXPECT_EQ(map.snapshot().state({0.55, 0.05, 0.05}), expected);
    }
  }
}

}  // namespace free_space_map_test
}  // namespace clearway
