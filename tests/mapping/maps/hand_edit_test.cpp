#include "mapping/maps/hand_edit.hpp"

#include <gtest/gtest.h>

#include <array>
#include <random>
#include <set>

#include "mapping/files/map_file.hpp"
#include "mapping/free_space_map.hpp"
#include "mapping/maps/map_damage.hpp"
#include "mapping/maps/map_edit.hpp"
#include "mapping/voxels/fused_tree.hpp"
#include "tests/worlds/temporary_folder.hpp"

namespace clearway {
namespace hand_edit_test {

using Cell = std::array<int, 3>;

Eigen::Vector3d center(const Cell& cell) {
  return 0.1 * Eigen::Vector3d(cell[0] + 0.5, cell[1] + 0.5, cell[2] + 0.5);
}

/// A wall at x = 0.55 seen from the origin, and paint on a part of it.
Snapshot wall() {
  FreeSpaceMap map({.resolution = 0.1});
  map.add_volume("tunnel", {"tool"});
  Scan scan;
  scan.time = 4.0;
  scan.map_from_sensor.translation() = Eigen::Vector3d(0.05, 0.05, 0.05);
  for (int y = -3; y <= 3; ++y)
    for (int z = -3; z <= 3; ++z)
      scan.points.emplace_back(0.5F, 0.1F * static_cast<float>(y), 0.1F * static_cast<float>(z));
  map.insert(scan);
  map.paint(0, {{0.45, 0.05, 0.05}, 0.25}, 5.0);
  return map.snapshot();
}

std::vector<Cell> random_cells(std::mt19937& random) {
  std::uniform_int_distribution<int> one(-8, 8);
  std::set<Cell> cells;
  for (int i = 0; i < 600; ++i) cells.insert({one(random), one(random), one(random)});
  return {cells.begin(), cells.end()};
}

/// Voxel by voxel against the rule: occupied or not as the edit says, paint as before, and of other voxels
/// nothing changes. Cells of pruned leaves are among them.
TEST(HandEdit, ChangesTheseVoxelsAndNoOthers) {
  std::mt19937 random(5);
  for (const bool is_occupied : {true, false}) {
    for (int round = 0; round < 5; ++round) {
      const Snapshot map = wall();
      const std::vector<Cell> cells = random_cells(random);
      std::vector<Eigen::Vector3d> points;
      for (const Cell& cell : cells) points.push_back(center(cell));
      HandEditTally tally, expected;
      const Snapshot made =
          is_occupied ? with_occupied_voxels(map, points, tally) : with_cleared_voxels(map, points, tally);
      const std::set<Cell> chosen(cells.begin(), cells.end());
      for (int x = -10; x <= 10; ++x)
        for (int y = -10; y <= 10; ++y)
          for (int z = -10; z <= 10; ++z) {
            const Voxel before = map.voxel(center({x, y, z})), now = made.voxel(center({x, y, z}));
            EXPECT_EQ(now.volumes, before.volumes);
            if (!chosen.contains({x, y, z})) {
              EXPECT_EQ(now.state, before.state);
              continue;
            }
            const bool is_painted = before.volumes != 0;
            using enum VoxelState;
            EXPECT_EQ(now.state,
                      is_occupied ? (is_painted ? conflict : occupied) : (is_painted ? painted : seen_free));
            const bool was_occupied = before.state == occupied || before.state == conflict;
            if (is_occupied && !was_occupied) ++(is_painted ? expected.conflict : expected.occupied);
            if (!is_occupied && (was_occupied || !before.observed))
              ++(is_painted ? expected.painted : expected.seen_free);
          }
      EXPECT_EQ(tally.occupied, expected.occupied);
      EXPECT_EQ(tally.conflict, expected.conflict);
      EXPECT_EQ(tally.seen_free, expected.seen_free);
      EXPECT_EQ(tally.painted, expected.painted);
      EXPECT_GT(is_occupied ? tally.conflict : tally.painted, 0U);
      EXPECT_GT(is_occupied ? tally.occupied : tally.seen_free, 0U);
    }
  }
}

/// What is cleared by hand was not looked at: where an age is asked for it blocks.
TEST(HandEdit, AClearedVoxelThatNoSensorSawHasNoTime) {
  HandEditTally tally;
  const Eigen::Vector3d behind(0.95, 0.05, 0.05);
  const Snapshot made = with_cleared_voxels(wall(), {behind}, tally);
  EXPECT_EQ(made.state(behind), VoxelState::seen_free);
  EXPECT_FALSE(made.last_seen(behind));
  EXPECT_TRUE(made.last_seen({0.25, 0.05, 0.05}));
}

TEST(HandEdit, StaysInTheFileAndInWhatIsMadeOfTheMap) {
  const TemporaryFolder folder;
  HandEditTally tally;
  EXPECT_EQ(hand_edit_caveat(wall()), "");
  EXPECT_EQ(map_caveat(wall()).find("by hand"), std::string::npos);
  Snapshot map = with_occupied_voxels(wall(), {{2.05, 0.05, 0.05}, {2.15, 0.05, 0.05}}, tally);
  map = with_cleared_voxels(map, {{2.15, 0.05, 0.05}}, tally);
  EXPECT_EQ(hand_edit_caveat(map), "the map was edited by hand: 2 voxels made occupied, 1 voxel made free");
  save_map(map, folder / "map");
  const Snapshot loaded = load_map(folder / "map");
  const Eigen::AlignedBox3d box(Eigen::Vector3d(0, 0, 0), Eigen::Vector3d(0.2, 0.2, 0.2));
  for (const Snapshot& made : {loaded, coarsen(loaded, 0.2), merge(loaded, wall()), merge(wall(), loaded)}) {
    EXPECT_EQ(hand_edit_caveat(made), hand_edit_caveat(map));
    EXPECT_NE(map_caveat(made).find(hand_edit_caveat(map)), std::string::npos);
  }
  const Snapshot part = crop(loaded, box);
  EXPECT_TRUE(hand_edit_caveat(part).starts_with(hand_edit_caveat(map) + "; the map was cropped: "));
  EXPECT_EQ(merge(loaded, map).tree().hand_edits(), (HandEdits{4, 2}));
  FreeSpaceMap same({.resolution = 0.1});
  EXPECT_EQ(same.snapshot().tree().hand_edits(), HandEdits{});
}

TEST(HandEdit, OccupiedVoxelsThatACropCutsOffAreTold) {
  const TemporaryFolder folder;
  const Snapshot map = wall();
  const auto occupied = [](const Snapshot& one) { return one.counts().occupied + one.counts().conflict; };
  const double far = 100.0;
  EXPECT_EQ(hand_edit_caveat(crop(map, {Eigen::Vector3d(-far, -far, -far), Eigen::Vector3d(far, far, far)})),
            "");
  const Snapshot part = crop(map, {Eigen::Vector3d(0, 0, 0), Eigen::Vector3d(0.2, 0.2, 0.2)});
  EXPECT_EQ(part.tree().hand_edits().cut, occupied(map) - occupied(part));
  const std::string told = "the map was cropped: " + std::to_string(occupied(map) - occupied(part)) +
                           " occupied voxels were cut off";
  EXPECT_EQ(hand_edit_caveat(part), told);
  save_map(part, folder / "part");
  EXPECT_EQ(hand_edit_caveat(load_map(folder / "part")), told);
  EXPECT_EQ(hand_edit_caveat(merge(part, map)), told);
}

/// As if it had been hit more often than a map counts: looks past it take as long as of any obstacle.
TEST(HandEdit, AnObstacleMadeByHandIsAsCertainAsOneThatWasHitOftenest) {
  const Snapshot before = wall();
  HandEditTally tally;
  const Cell seen{1, 0, 0}, unknown{-30, 0, 0}, painted{4, 0, 0};
  const Snapshot after =
      with_occupied_voxels(before, {center(seen), center(unknown), center(painted)}, tally);
  for (const Cell& cell : {seen, unknown, painted})
    EXPECT_FLOAT_EQ(after.voxel(center(cell)).log_odds, before.tree().getClampingThresMaxLog());
}

}  // namespace hand_edit_test
}  // namespace clearway
