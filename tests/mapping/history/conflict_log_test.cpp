// Conflicts with time and source, against states compared before and after each step.

#include "mapping/history/conflict_log.hpp"

#include <gtest/gtest.h>

#include <map>
#include <set>

#include "mapping/free_space_map.hpp"
#include "mapping/voxels/fused_tree.hpp"
#include "tests/worlds/random_map.hpp"

namespace clearway {
namespace conflict_log_test {

using Cell = std::array<int, 3>;

std::set<Cell> conflicts_of(const Snapshot& map) {
  std::set<Cell> cells;
  map.tree().visit_leaves([&](const FusedNode& node, const CellCube& cube) {
    if (map.tree().state(node) != VoxelState::conflict) return;
    for (int i = 0; i < cube.edge * cube.edge * cube.edge; ++i) {
      cells.insert({cube.corner.x() + i % cube.edge, cube.corner.y() + i / cube.edge % cube.edge,
                    cube.corner.z() + i / cube.edge / cube.edge});
    }
  });
  return cells;
}

TEST(ConflictLog, HoldsEveryVoxelThatBecomesAConflictWithWhatCameSecond) {
  std::size_t by_scan = 0, by_paint = 0;
  for (unsigned seed = 0; seed < 12; ++seed) {
    worlds::Dice dice(seed);
    FreeSpaceMap map({.resolution = 0.05});
    map.add_volume("a", {});
    map.add_volume("b", {});
    std::set<Cell> before;
    std::size_t seen = 0;
    int scans = 0, strokes = 0;
    for (int step = 0; step < 30; ++step) {
      const int kind = dice.whole(0, 5), volume = dice.whole(0, 1);
      const double time = 0.5 * step;
      if (kind < 3) {
        Scan scan = worlds::random_scan(dice, 150);
        scan.time = time;
        map.insert(scan);
        ++scans;
      } else if (kind < 5) {
        map.begin_stroke("stroke " + std::to_string(strokes++));
        map.paint(volume, worlds::random_sphere(dice), time);
      } else {
        map.erase(volume, worlds::random_sphere(dice), time);
      }
      const std::set<Cell> now = conflicts_of(map.snapshot());
      std::set<Cell> expected;
      for (const Cell& cell : now) {
        if (!before.contains(cell)) expected.insert(cell);
      }
      const auto& records = map.conflicts().records;
      std::set<Cell> found;
      for (; seen < records.size(); ++seen) {
        const ConflictRecord& record = records[seen];
        found.insert({record.cell.x(), record.cell.y(), record.cell.z()});
        EXPECT_EQ(record.time, time);
        EXPECT_EQ(record.by_scan, kind < 3);
        EXPECT_EQ(record.index, kind < 3 ? scans - 1 : strokes - 1);
        EXPECT_EQ(record.volume, kind < 3 ? -1 : volume);
        ++(record.by_scan ? by_scan : by_paint);
      }
      EXPECT_EQ(found, expected) << "seed " << seed << " step " << step;
      before = now;
    }
    EXPECT_EQ(map.conflicts().not_kept, 0U);
  }
  EXPECT_GT(by_scan, 50U);
  EXPECT_GT(by_paint, 50U);
}

TEST(ConflictLog, CountsWhatItHasNoRoomFor) {
  Scan scan;
  for (int i = 0; i < 110; ++i) {
    for (int j = 0; j < 110; ++j) scan.points.emplace_back(0.505F, 0.01F * i - 0.545F, 0.01F * j - 0.545F);
  }
  FreeSpaceMap map({.resolution = 0.01});
  map.add_volume("v", {});
  map.insert(scan);
  const std::size_t occupied = map.snapshot().counts().occupied;
  map.paint(0, {{0.0, 0.0, 0.0}, 3.0});
  const std::size_t conflicts = map.snapshot().counts().conflict;
  ASSERT_EQ(conflicts, occupied);
  ASSERT_GT(conflicts, ConflictLog::record_limit);
  EXPECT_EQ(map.conflicts().records.size(), ConflictLog::record_limit);
  EXPECT_EQ(map.conflicts().not_kept, conflicts - ConflictLog::record_limit);
}

}  // namespace conflict_log_test
}  // namespace clearway
