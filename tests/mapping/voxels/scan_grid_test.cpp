#include "mapping/voxels/scan_grid.hpp"

#include <gtest/gtest.h>

#include <map>
#include <tuple>

#include "tests/worlds/random_map.hpp"

namespace clearway {
namespace scan_grid_test {

using worlds::Dice;

Eigen::Vector3i random_cell(Dice& dice, int reach) {
  return {dice.whole(-reach, reach - 1), dice.whole(-reach, reach - 1), dice.whole(-reach, reach - 1)};
}

TEST(ScanGrid, EveryCellOfATileHasItsOwnBitAndTheBitKnowsTheCell) {
  ScanTile tile;
  tile.corner = {-64, 32, 0};
  std::vector<bool> taken(32768);
  for (int i = 0; i < 32768; ++i) {
    const Eigen::Vector3i cell = tile.corner + Eigen::Vector3i(i % 32, i / 32 % 32, i / 1024);
    const unsigned bit = ScanTile::bit_of(cell);
    ASSERT_FALSE(taken[bit]);
    taken[bit] = true;
    ASSERT_EQ(tile.cell_of(bit), cell);
  }
}

TEST(ScanGrid, KeepsWhatWasSetAsAPlainMapDoes) {
  Dice dice(1);
  ScanGrid grid;
  for (int round = 0; round < 3; ++round) {
    std::map<std::tuple<int, int, int>, std::pair<bool, bool>> truth;  // free, occupied
    const int reach = round == 0 ? 40 : round == 1 ? 500 : 32768;
    for (int i = 0; i < 5000; ++i) {
      const Eigen::Vector3i cell = random_cell(dice, reach);
      auto& expected = truth[{cell.x(), cell.y(), cell.z()}];
      switch (dice.whole(0, 2)) {
        case 0:
          grid.set_free(cell);
          expected.first = true;
          break;
        case 1:
          EXPECT_EQ(grid.set_occupied(cell), !expected.second);
          expected.second = true;
          break;
        default:
          grid.clear_free(cell);
          expected.first = false;
      }
    }
    for (const auto& [at, expected] : truth) {
      const Eigen::Vector3i cell(std::get<0>(at), std::get<1>(at), std::get<2>(at));
      ASSERT_EQ(grid.is_free(cell), expected.first);
      ASSERT_EQ(grid.is_occupied(cell), expected.second);
    }
    grid.clear();
    EXPECT_TRUE(grid.tiles().empty());
    for (const auto& [at, expected] : truth)
      ASSERT_FALSE(grid.is_free({std::get<0>(at), std::get<1>(at), std::get<2>(at)}));
  }
}

TEST(ScanGrid, TilesComeInOctreeOrder) {
  Dice dice(2);
  ScanGrid grid;
  for (int i = 0; i < 300; ++i) grid.set_free(random_cell(dice, 32768));
  const std::vector<ScanTile*> tiles = grid.tiles();
  EXPECT_GT(tiles.size(), 250U);
  for (std::size_t i = 1; i < tiles.size(); ++i) {
    const Eigen::Vector3i a = tiles[i - 1]->corner, b = tiles[i]->corner;
    int level = 15;  // of the highest cube that parts the two
    while (((a.array() + 32768).unaryExpr([&](int v) { return v >> level; }) ==
            (b.array() + 32768).unaryExpr([&](int v) {
              return v >> level;
            })).all())
      --level;
    const auto child = [&](const Eigen::Vector3i& corner) {
      int index = 0;
      for (int axis = 0; axis < 3; ++axis) index |= ((corner[axis] + 32768) >> level & 1) << axis;
      return index;
    };
    ASSERT_LT(child(a), child(b));
  }
}

}  // namespace scan_grid_test
}  // namespace clearway
