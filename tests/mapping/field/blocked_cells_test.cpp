#include "mapping/field/blocked_cells.hpp"

#include <gtest/gtest.h>

#include <vector>

#include "mapping/voxels/fused_tree.hpp"
#include "tests/worlds/random_map.hpp"

namespace clearway {
namespace blocked_cells_test {

using worlds::Dice;

const std::vector<Requirement> requirements = {
    {Policy::not_occupied}, {Policy::known_free}, {Policy::painted}, {Policy::painted, 2}};
const Eigen::Vector3i first(-9, -21, -6), size(67, 45, 30);

TEST(BlockedCells, FillingAndReadingAgreeWithAPlainArray) {
  Dice dice(1);
  for (const bool start : {false, true}) {
    BlockedCells cells(size, start);
    std::vector<char> plain(static_cast<std::size_t>(size.prod()), start ? 1 : 0);
    const auto at = [&](int x, int y, int z) -> char& {
      return plain[static_cast<std::size_t>((z * size.y() + y) * size.x() + x)];
    };
    for (int i = 0; i < 40; ++i) {
      const Eigen::Vector3i low(dice.whole(0, 66), dice.whole(0, 44), dice.whole(0, 29));
      const Eigen::Vector3i high = (low + Eigen::Vector3i(dice.whole(1, 67), 3, 4)).cwiseMin(size);
      const bool blocked = dice.whole(0, 1) == 0;
      cells.fill(low, high, blocked);
      for (int z = low.z(); z < high.z(); ++z) {
        for (int y = low.y(); y < high.y(); ++y) {
          for (int x = low.x(); x < high.x(); ++x) at(x, y, z) = blocked ? 1 : 0;
        }
      }
    }
    std::size_t count = 0;
    for (int z = 0; z < size.z(); ++z) {
      for (int y = 0; y < size.y(); ++y) {
        for (int x = 0; x < size.x(); ++x) {
          ASSERT_EQ(cells.at(x, y, z), at(x, y, z) != 0);
          count += cells.at(x, y, z) ? 1 : 0;
          unsigned around = 0;
          for (int k = -1; k <= 1; ++k) {
            if (x + k >= 0 && x + k < size.x() && at(x + k, y, z) != 0) around |= 1U << (k + 1);
          }
          ASSERT_EQ(cells.around(x, y, z), around);
        }
      }
    }
    EXPECT_EQ(cells.count(), count);
  }
}

TEST(BlockedCells, AreWhatTheRequirementForbidsOfTheTree) {
  const Snapshot map = worlds::random_map(4, 0.05).snapshot();
  for (const Requirement& requirement : requirements) {
    const BlockedCells cells = blocked_cells(map.tree(), requirement, first, size);
    for (int z = 0; z < size.z(); ++z) {
      for (int y = 0; y < size.y(); ++y) {
        for (int x = 0; x < size.x(); ++x) {
          const Eigen::Vector3d center =
              ((first + Eigen::Vector3i(x, y, z)).cast<double>().array() + 0.5) * 0.05;
          const Voxel voxel = map.voxel(center);
          ASSERT_EQ(cells.at(x, y, z), !allows(requirement, voxel.state, voxel.volumes));
        }
      }
    }
  }
}

TEST(BlockedCells, BoxesHoldAllThatIsForbiddenAndLittleElse) {
  for (unsigned seed = 1; seed < 5; ++seed) {
    const Snapshot map = worlds::random_map(seed, 0.05).snapshot();
    for (const Requirement& requirement : requirements) {
      const BlockedCells cells = blocked_cells(map.tree(), requirement, first, size);
      for (const int narrow : {1, 4, 8}) {
        BlockedCells boxes(size, false);
        std::size_t mixed = 0;
        visit_blocked_boxes(map.tree(), requirement, first, size, narrow, [&](const CellBox& box) {
          ASSERT_TRUE((box.low.array() >= 0).all() && (box.high.array() <= size.array()).all());
          ASSERT_TRUE((box.low.array() < box.high.array()).all());
          boxes.fill(box.low, box.high, true);
          std::size_t forbidden = 0;
          for (int z = box.low.z(); z < box.high.z(); ++z)
            for (int y = box.low.y(); y < box.high.y(); ++y)
              for (int x = box.low.x(); x < box.high.x(); ++x) forbidden += cells.at(x, y, z) ? 1 : 0;
          const bool is_whole = forbidden == static_cast<std::size_t>((box.high - box.low).prod());
          EXPECT_TRUE(is_whole || (box.high - box.low).maxCoeff() <= narrow);
          mixed += !is_whole;
        });
        BlockedCells both(size, false);
        both.block_where_both(cells, boxes);
        EXPECT_EQ(both, cells);
        if (narrow == 1) {
          EXPECT_EQ(boxes, cells);
        } else {
          EXPECT_GT(mixed + (boxes.count() == cells.count()), 0U);
        }
      }
    }
  }
}

/// Earlier cells with those of the boxes from a later version.
BlockedCells copied_where(const std::vector<CellBox>& boxes, const BlockedCells& later,
                          const BlockedCells& earlier) {
  BlockedCells cells = earlier;
  for (const CellBox& box : boxes) {
    for (int z = box.low.z(); z < box.high.z(); ++z) {
      for (int y = box.low.y(); y < box.high.y(); ++y)
        for (int x = box.low.x(); x < box.high.x(); ++x) cells.set(x, y, z, later.at(x, y, z));
    }
  }
  return cells;
}

/// Earlier cells turned over in the boxes that following names: each cell of them changed.
BlockedCells turned_where_followed(const FusedTree& tree, const Requirement& requirement,
                                   const FusedTree& before, const BlockedCells& earlier, int threads) {
  BlockedCells followed = earlier, cells = earlier;
  for (const CellBox& box : follow_blocked_cells(tree, requirement, first, before, followed, threads)) {
    for (int z = box.low.z(); z < box.high.z(); ++z) {
      for (int y = box.low.y(); y < box.high.y(); ++y)
        for (int x = box.low.x(); x < box.high.x(); ++x) cells.set(x, y, z, !cells.at(x, y, z));
    }
  }
  return cells;
}

TEST(BlockedCells, FollowingTheChangesOfATreeGivesWhatReadingItWholeGives) {
  Dice dice(5);
  FreeSpaceMap map = worlds::random_map(5, 0.05, 2);
  Snapshot before = map.snapshot();
  for (int round = 0; round < 12; ++round) {
    if (round % 3 != 0) map.insert(worlds::random_scan(dice, round % 2 == 0 ? 5 : 300));
    if (round % 3 != 1) map.paint(dice.whole(0, 1), worlds::random_sphere(dice), 1.0 + round);
    const Snapshot now = map.snapshot();
    for (const Requirement& requirement : requirements) {
      const BlockedCells was = blocked_cells(before.tree(), requirement, first, size);
      const BlockedCells is = blocked_cells(now.tree(), requirement, first, size);
      ASSERT_EQ(blocked_cells(now.tree(), requirement, first, before.tree(), was), is);
      ASSERT_EQ(copied_where(is.differing(was), is, was), is);
      for (const int threads : {2, 5}) {
        ASSERT_EQ(blocked_cells(now.tree(), requirement, first, before.tree(), was, threads), is);
        ASSERT_EQ(turned_where_followed(now.tree(), requirement, before.tree(), was, threads), is);
        ASSERT_EQ(blocked_cells(now.tree(), requirement, first, size, threads), is);
      }
      ASSERT_EQ(is.count_beyond(was) + static_cast<std::ptrdiff_t>(was.count()),
                static_cast<std::ptrdiff_t>(is.count()));
    }
    before = now;
  }
}

}  // namespace blocked_cells_test
}  // namespace clearway
