// Distances of changing cells, against brute force and against a fresh start.

#include "mapping/field/distance_layers.hpp"

#include <gtest/gtest.h>

#include <algorithm>

#include "tests/worlds/random_map.hpp"

namespace clearway {
namespace distance_layers_test {

using worlds::Dice;

Eigen::Vector3i random_cell(Dice& dice, const Eigen::Vector3i& size) {
  return {dice.whole(0, size.x() - 1), dice.whole(0, size.y() - 1), dice.whole(0, size.z() - 1)};
}

void fill_box(Dice& dice, BlockedCells& cells, int edge, bool blocked) {
  const Eigen::Vector3i low = random_cell(dice, cells.size());
  const Eigen::Vector3i reach(dice.whole(1, edge), dice.whole(1, edge), dice.whole(1, edge));
  cells.fill(low, (low + reach).cwiseMin(cells.size()), blocked);
}

template <class Visit>
void visit_cells(const Eigen::Vector3i& size, const Visit& visit) {
  for (int z = 0; z < size.z(); ++z) {
    for (int y = 0; y < size.y(); ++y) {
      for (int x = 0; x < size.x(); ++x) visit(x, y, z);
    }
  }
}

std::size_t count_differences(const DistanceLayers& a, const DistanceLayers& b) {
  std::size_t count = 0;
  visit_cells(a.blocked().size(),
              [&](int x, int y, int z) { count += a.squared(x, y, z) != b.squared(x, y, z); });
  return count;
}

/// Every cell of the layers against the distances to all blocked cubes.
void expect_exact(const DistanceLayers& layers, const std::vector<Eigen::Vector3i>& cells) {
  visit_cells(layers.blocked().size(), [&](int x, int y, int z) {
    int expected = layers.cap();
    for (const Eigen::Vector3i& cell : cells) {
      const Eigen::Vector3i gap =
          (2 * (cell - Eigen::Vector3i(x, y, z)).cwiseAbs().array() - 1).max(0).matrix();
      expected = std::min(expected, gap.squaredNorm());
    }
    ASSERT_EQ(int{layers.squared(x, y, z)}, expected)
        << x << " " << y << " " << z << " cap " << layers.cap() << " of " << layers.blocked().count();
  });
}

TEST(DistanceLayers, HoldExactlyTheDistanceToTheNearestCube) {
  Dice dice(1);
  for (int trial = 0; trial < 30; ++trial) {
    const Eigen::Vector3i size(dice.whole(1, 70), dice.whole(1, 30), dice.whole(1, 30));
    BlockedCells blocked(size, false);
    std::vector<Eigen::Vector3i> cells;
    for (int i = dice.whole(0, 25); i > 0; --i) {
      cells.push_back(random_cell(dice, size));
      blocked.fill(cells.back(), cells.back() + Eigen::Vector3i::Ones(), true);
    }
    const auto cap = static_cast<std::uint16_t>(dice.whole(1, trial % 2 == 0 ? 400 : largest_cap));
    expect_exact(DistanceLayers(blocked, cap, trial % 3 != 0), cells);
  }
}

TEST(DistanceLayers, AreExactForTheSmallestCapsAndACubeAnywhereInARow) {
  for (const std::uint16_t cap : {1, 2, 9, 10, 11, 25, 26}) {  // just what some of the nearest cells are away
    for (int x = 0; x < 66; ++x) {                             // two words of a row, and a bit
      const Eigen::Vector3i cell(x, x % 3, x / 3 % 3);
      BlockedCells blocked({66, 3, 3}, false);
      const DistanceLayers empty(blocked, cap, true);
      blocked.fill(cell, cell + Eigen::Vector3i::Ones(), true);
      expect_exact(DistanceLayers(blocked, cap, false), {cell});
      expect_exact(DistanceLayers(empty, blocked), {cell});
    }
  }
}

TEST(DistanceLayers, AfterAnySequenceOfChangesTheyAreThoseMadeFromNothing) {
  Dice dice(2);
  for (int trial = 0; trial < 12; ++trial) {
    const Eigen::Vector3i size(dice.whole(1, 150), dice.whole(1, 60), dice.whole(1, 60));
    const auto cap = static_cast<std::uint16_t>(dice.whole(1, trial % 2 == 0 ? 3000 : largest_cap));
    BlockedCells blocked(size, trial % 4 == 0);
    auto layers = std::make_unique<DistanceLayers>(blocked, cap, true);
    for (int round = 0; round < 10; ++round) {
      for (int i = dice.whole(0, 8); i > 0; --i)
        fill_box(dice, blocked, dice.whole(1, 20), dice.whole(0, 1) == 0);
      layers = std::make_unique<DistanceLayers>(*layers, blocked);
      ASSERT_EQ(layers->blocked(), blocked);
      ASSERT_EQ(count_differences(*layers, DistanceLayers(blocked, cap, false)), 0U);
    }
  }
}

TEST(DistanceLayers, AreTheSameForAnyNumberOfThreads) {
  Dice dice(4);
  for (const bool start : {false, true}) {
    BlockedCells blocked({150, 70, 60}, start);
    for (int i = 0; i < 30; ++i) fill_box(dice, blocked, 15, !start);
    BlockedCells later = blocked;
    for (int i = 0; i < 30; ++i) fill_box(dice, later, 9, i % 2 == 0);
    const DistanceLayers before(blocked, 1500, true), after(before, later);
    for (const int threads : {2, 3, 16}) {
      const DistanceLayers many(blocked, 1500, true, threads);
      EXPECT_EQ(count_differences(many, before), 0U);
      EXPECT_EQ(count_differences(DistanceLayers(blocked, 1500, false, threads), before), 0U);
      EXPECT_EQ(count_differences(DistanceLayers(many, later, threads), after), 0U);
    }
  }
}

TEST(DistanceLayers, TheVersionBeforeAChangeStaysAsItWas) {
  Dice dice(3);
  BlockedCells blocked({100, 50, 40}, false);
  for (int i = 0; i < 30; ++i) fill_box(dice, blocked, 9, true);
  const DistanceLayers before(blocked, 1500, true);
  BlockedCells later = blocked;
  for (int i = 0; i < 30; ++i) fill_box(dice, later, 9, i % 2 == 0);
  const DistanceLayers after(before, later);
  EXPECT_EQ(count_differences(before, DistanceLayers(blocked, 1500, true)), 0U);
  EXPECT_GT(count_differences(before, after), 1000U);
}

TEST(DistanceLayers, ASmallChangeCopiesFewTiles) {
  BlockedCells blocked({320, 160, 160}, false);
  blocked.fill({0, 0, 0}, {320, 160, 2}, true);
  const DistanceLayers before(blocked, 400, true);
  blocked.fill({160, 80, 50}, {161, 81, 51}, true);
  const DistanceLayers after(before, blocked);
  std::size_t shared = 0, lines = 0;
  for (int z = 0; z < 160; ++z) {
    for (int y = 0; y < 160; ++y) {
      for (int lane = 0; lane < 10; ++lane, ++lines)
        shared += before.line(lane, y, z) == after.line(lane, y, z);
    }
  }
  EXPECT_GT(shared, lines * 98 / 100);
  EXPECT_LT(shared, lines);
}

TEST(DistanceLayers, EmptySpaceTakesHardlyAnyMemory) {
  const DistanceLayers empty(BlockedCells({256, 256, 256}, false), 400, true);
  EXPECT_LT(empty.bytes(), 256U * 256U * 256U / 4U);
}

}  // namespace distance_layers_test
}  // namespace clearway
