// The distance transform against brute force over all pairs of cells.

#include "mapping/field/distance_transform.hpp"

#include <gtest/gtest.h>

#include <algorithm>

#include "tests/worlds/random_map.hpp"

namespace clearway {
namespace distance_transform_test {

using worlds::Dice;

int gap_squared(int delta) {
  const int gap = std::max(2 * std::abs(delta) - 1, 0);
  return gap * gap;
}

struct Cell {
  int x, y, z;
};

DistanceBlock random_block(Dice& dice, int nx, int ny, int nz, std::uint16_t cap, int blocked,
                           std::vector<Cell>& cells) {
  DistanceBlock block(nx, ny, nz, cap);
  for (int i = 0; i < blocked; ++i) {
    cells.push_back({dice.whole(0, nx - 1), dice.whole(0, ny - 1), dice.whole(0, nz - 1)});
    block.squared[block.index(cells.back().x, cells.back().y, cells.back().z)] = 0;
  }
  return block;
}

void expect_exact(const DistanceBlock& block, const std::vector<Cell>& blocked) {
  for (int z = 0; z < block.nz; ++z) {
    for (int y = 0; y < block.ny; ++y) {
      for (int x = 0; x < block.nx; ++x) {
        int expected = block.cap;
        for (const Cell& cell : blocked) {
          expected =
              std::min(expected, gap_squared(x - cell.x) + gap_squared(y - cell.y) + gap_squared(z - cell.z));
        }
        ASSERT_EQ(block.squared[block.index(x, y, z)], expected) << x << " " << y << " " << z;
      }
    }
  }
}

TEST(DistanceTransform, IsExactlyTheDistanceToTheNearestCube) {
  Dice dice(1);
  for (int trial = 0; trial < 60; ++trial) {
    const auto cap =
        static_cast<std::uint16_t>(dice.whole(0, 1) == 0 ? dice.whole(1, 400) : dice.whole(400, 32767));
    std::vector<Cell> blocked;
    DistanceBlock block = random_block(dice, dice.whole(1, 70), dice.whole(1, 30), dice.whole(1, 30), cap,
                                       dice.whole(0, 25), blocked);
    transform_distances(block);
    expect_exact(block, blocked);
  }
}

TEST(DistanceTransform, RowsArePaddedToTheNextMultipleOfALane) {
  for (int x = 1; x < 100; ++x) {
    const DistanceBlock block(x, 3, 2, 7);
    EXPECT_GE(block.stride, x);
    EXPECT_LT(block.stride, x + DistanceBlock::lane);
    EXPECT_EQ(block.stride % DistanceBlock::lane, 0);
    EXPECT_EQ(block.squared.size(), static_cast<std::size_t>(block.stride) * 6);
    EXPECT_EQ(block.index(x - 1, 2, 1),
              static_cast<std::size_t>(block.stride) * 5 + static_cast<std::size_t>(x) - 1);
  }
}

TEST(DistanceTransform, ReachesTheLargestCapAlongEveryAxis) {
  for (int axis = 0; axis < 3; ++axis) {
    DistanceBlock block(axis == 0 ? 200 : 1, axis == 1 ? 200 : 1, axis == 2 ? 200 : 1, largest_cap);
    block.squared[0] = 0;
    transform_distances(block);
    expect_exact(block, {{0, 0, 0}});
  }
}

TEST(DistanceTransform, NothingBlockedLeavesTheCapEverywhereAndAllBlockedZero) {
  DistanceBlock empty(33, 5, 4, 100), full(33, 5, 4, 100);
  transform_distances(empty);
  EXPECT_TRUE(std::all_of(empty.squared.begin(), empty.squared.end(), [](auto v) { return v == 100; }));
  std::fill(full.squared.begin(), full.squared.end(), std::uint16_t{0});
  transform_distances(full);
  EXPECT_TRUE(std::all_of(full.squared.begin(), full.squared.end(), [](auto v) { return v == 0; }));
}

}  // namespace distance_transform_test
}  // namespace clearway
