#include "mapping/field/tiled_cells.hpp"

#include <gtest/gtest.h>

#include "tests/worlds/random_map.hpp"

namespace clearway {
namespace tiled_cells_test {

using Line = std::array<std::uint16_t, TiledCells::nx>;

Line line_of(std::uint16_t value) {
  Line line;
  line.fill(value);
  return line;
}

TEST(TiledCells, HoldWhatWasWrittenLastAndOnlyThere) {
  worlds::Dice dice(1);
  const Eigen::Vector3i size(70, 20, 17);
  TiledCells cells(size, 7);
  std::vector<std::uint16_t> plain(static_cast<std::size_t>(size.prod()), 7);
  for (int i = 0; i < 500; ++i) {
    const int lane = dice.whole(0, 2), y = dice.whole(0, 19), z = dice.whole(0, 16);
    const auto value = static_cast<std::uint16_t>(dice.whole(0, 65535));
    const bool differs = cells.at(32 * lane, y, z) != value;
    EXPECT_EQ(cells.write(lane, y, z, line_of(value).data()), differs);
    for (int x = 32 * lane; x < std::min(32 * lane + 32, 70); ++x) {
      plain[static_cast<std::size_t>((z * 20 + y) * 70 + x)] = value;
    }
  }
  for (int z = 0; z < 17; ++z) {
    for (int y = 0; y < 20; ++y) {
      for (int x = 0; x < 70; ++x) {
        ASSERT_EQ(cells.at(x, y, z), plain[static_cast<std::size_t>((z * 20 + y) * 70 + x)]);
      }
    }
  }
}

TEST(TiledCells, ACopyIsWrittenWithoutChangingTheOriginal) {
  TiledCells original({64, 16, 16}, 1);
  original.write(0, 3, 3, line_of(2).data());
  TiledCells copy(original);
  copy.write(0, 3, 4, line_of(3).data());
  copy.write(1, 9, 9, line_of(4).data());
  EXPECT_EQ(original.at(5, 3, 4), 1);
  EXPECT_EQ(original.at(40, 9, 9), 1);
  EXPECT_EQ(copy.at(5, 3, 3), 2);
  EXPECT_EQ(copy.at(5, 3, 4), 3);
  EXPECT_EQ(copy.at(40, 9, 9), 4);
  EXPECT_EQ(copy.line(1, 0, 0), original.line(1, 0, 0));  // an unchanged tile is shared
}

TEST(TiledCells, WhatIsAlikeTakesOneTile) {
  TiledCells cells({320, 80, 80}, 9);
  EXPECT_EQ(cells.distinct_tiles(), 1U);
  cells.write(2, 0, 0, line_of(9).data());
  EXPECT_EQ(cells.distinct_tiles(), 1U);
  cells.write(2, 0, 0, line_of(8).data());
  EXPECT_EQ(cells.distinct_tiles(), 2U);
}

}  // namespace tiled_cells_test
}  // namespace clearway
