// One descent per scan against OctoMap's updateNode (in safe integration: the rule of one voxel) voxel by
// voxel, on painted and shared trees too.

#include <gtest/gtest.h>

#include <sstream>

#include "mapping/voxels/fused_tree.hpp"
#include "mapping/voxels/occupancy_update.hpp"
#include "mapping/voxels/scan_grid.hpp"
#include "tests/worlds/random_map.hpp"
#include "tests/worlds/stock_octomap.hpp"

namespace clearway {
namespace fused_tree_update_test {

using worlds::Dice;

octomap::OcTreeKey key_of(const Eigen::Vector3i& cell) {
  return {static_cast<octomap::key_type>(cell.x() + 32768), static_cast<octomap::key_type>(cell.y() + 32768),
          static_cast<octomap::key_type>(cell.z() + 32768)};
}

/// Boxes of free cells, aligned cubes among them, and some hits.
void fill(Dice& dice, ScanGrid& grid) {
  for (int box = dice.whole(1, 4); box > 0; --box) {
    const int edge = 1 << dice.whole(0, 5);
    const bool aligned = dice.whole(0, 1) == 0;
    Eigen::Vector3i first(dice.whole(-80, 80), dice.whole(-80, 80), dice.whole(-80, 80));
    if (aligned)
      for (int axis = 0; axis < 3; ++axis) first[axis] &= ~(edge - 1);
    for (int i = 0; i < edge * edge * edge; ++i)
      grid.set_free(first + Eigen::Vector3i(i % edge, i / edge % edge, i / edge / edge));
    for (int hit = dice.whole(0, 30); hit > 0; --hit)
      grid.set_occupied(first +
                        Eigen::Vector3i(dice.whole(-2, edge), dice.whole(-2, edge), dice.whole(-2, edge)));
  }
}

void update_one_by_one(FusedTree& tree, ScanGrid& grid) {
  for (const ScanTile* tile : grid.tiles()) {
    for (unsigned bit = 0; bit < 32768; ++bit) {
      const std::uint64_t mask = std::uint64_t{1} << (bit & 63U);
      const bool hit = (tile->occupied[bit >> 6U] & mask) != 0;
      if (hit || (tile->free[bit >> 6U] & mask) != 0) tree.updateNode(key_of(tile->cell_of(bit)), hit);
    }
  }
}

/// Boxes of cells that are called clear, whatever else they are.
void fill_clear(Dice& dice, ScanGrid& grid) {
  for (ScanTile* tile : grid.tiles()) {
    tile->clear.fill(0);
    for (int box = dice.whole(0, 3); box > 0; --box) {
      const int first = dice.whole(0, 511), count = 1 << dice.whole(0, 9);
      for (int i = first & -count; i < (first & -count) + count; ++i)
        tile->clear[static_cast<std::size_t>(i)] = ~std::uint64_t{0};
    }
    tile->clear[7] ^= 0x123456789abcdef0U;
  }
}

void apply_one_by_one(FusedTree& tree, ScanGrid& grid) {
  const OccupancyUpdate rule{Integration::safe,
                             tree.getProbHitLog(),
                             tree.getProbMissLog(),
                             tree.getClampingThresMinLog(),
                             tree.getClampingThresMaxLog(),
                             tree.getOccupancyThresLog()};
  for (const ScanTile* tile : grid.tiles()) {
    for (unsigned bit = 0; bit < 32768; ++bit) {
      const auto is_in = [&](const auto& words) { return (words[bit >> 6U] >> (bit & 63U) & 1U) != 0; };
      const bool hit = is_in(tile->occupied), clear = is_in(tile->clear);
      if (!hit && !is_in(tile->free)) continue;
      CellCube cube;
      const FusedNode* leaf = tree.find_leaf(tile->cell_of(bit), cube);
      const float before = leaf != nullptr && leaf->observed() ? leaf->getLogOdds() : 0.0F;
      const float missed = clear ? rule.after_clear_look(before) : rule.after_miss(before);
      tree.set_observed(key_of(tile->cell_of(bit)), hit ? rule.after_hit(before) : missed);
    }
  }
  tree.finish();
}

std::string bytes_of(const FusedTree& tree) {
  std::ostringstream bytes;
  tree.writeData(bytes);
  return bytes.str();
}

class FusedTreeUpdate : public ::testing::TestWithParam<int> {};

TEST_P(FusedTreeUpdate, GivesTheTreeOfUpdatesOneByOne) {
  std::size_t pruned = 0;
  for (unsigned seed = 0; seed < 6; ++seed) {
    Dice dice(seed);
    FusedTree tree(0.05), slow(0.05);
    for (FusedTree* each : {&tree, &slow}) each->setClampingThresMin(seed % 2 == 0 ? 0.1192 : 0.3);
    ScanGrid grid;
    for (int round = 0; round < 9; ++round) {
      if (round % 3 != 0) grid.clear();  // every third scan repeats what was there, up to clamping
      fill(dice, grid);
      if (seed % 3 == 2) {
        const Sphere sphere{dice.point(3.0), dice.uniform(0.2, 1.5)};
        tree.paint(round % 2, sphere);
        slow.paint(round % 2, sphere);
      }
      update_one_by_one(slow, grid);
      tree.update(grid, Integration::compatible, GetParam());
      ASSERT_EQ(tree.size(), slow.size());
      ASSERT_EQ(tree.size(), tree.calcNumNodes());
      ASSERT_EQ(bytes_of(tree), bytes_of(slow)) << "seed " << seed << " round " << round;
    }
    for (auto leaf = tree.begin_leafs(); leaf != tree.end_leafs(); ++leaf)
      pruned += leaf.getDepth() < 14 ? 1 : 0;
  }
  EXPECT_GT(pruned, 100U);
}

TEST_P(FusedTreeUpdate, ACubeThatIsAsFreeAsCanBeIsLeftAloneUntilSomethingIsHitInIt) {
  constexpr int side = 64;  // eight tiles in one leaf
  FusedTree tree(0.05);
  octomap::OcTree stock(0.05);
  for (int i = 0; i < side * side * side; ++i) {
    const octomap::OcTreeKey key = key_of({i % side, i / side % side, i / side / side});
    stock.updateNode(key, -10.0F, true);
  }
  stock.updateInnerOccupancy();
  stock.prune();
  FusedNode settled;
  settled.observe(stock.getClampingThresMinLog());
  tree.set_leaf({Eigen::Vector3i::Zero(), side}, settled);
  tree.finish();
  worlds::expect_equal(stock, tree);
  const auto update = [&](ScanGrid& grid) {
    for (const ScanTile* tile : grid.tiles()) {
      for (unsigned bit = 0; bit < 32768; ++bit) {
        const auto is_in = [&](const auto& words) { return (words[bit >> 6U] >> (bit & 63U) & 1U) != 0; };
        const bool hit = is_in(tile->occupied);
        if (hit || is_in(tile->free)) stock.updateNode(key_of(tile->cell_of(bit)), hit);
      }
    }
    tree.update(grid, Integration::compatible, GetParam());
    worlds::expect_equal(stock, tree);
  };
  ScanGrid within, across, hits;
  for (int x = -40; x < 50; ++x) {
    if (x >= 0) within.set_free({x, 40, 3});
    across.set_free({x, 40, 3});
    hits.set_free({x, 40, 3});
  }
  update(within);
  EXPECT_EQ(tree.size(), 11U) << "the leaf, and the ten cubes that it lies in";
  update(across);
  hits.set_occupied({50, 40, 3});
  const std::size_t before = tree.size();
  update(hits);
  EXPECT_GT(tree.size(), before);
  update(hits);
}

TEST_P(FusedTreeUpdate, SafelyGivesTheTreeOfTheRuleOneByOne) {
  std::size_t forgotten = 0;  // large leaves that some clear looks split
  for (unsigned seed = 0; seed < 3; ++seed) {
    Dice dice(seed);
    FusedTree tree(0.05), slow(0.05);
    for (FusedTree* each : {&tree, &slow}) each->setOccupancyThres(seed % 2 == 0 ? 0.5 : 0.8);
    for (int round = 0; round < 9; ++round) {
      ScanGrid grid;
      if (round % 3 == 0) {  // cubes that are hit as a whole, and pruned
        for (int i = 0; i < 32768; ++i) grid.set_occupied({i % 32, i / 32 % 32, i / 1024});
      }
      if (round % 3 == 1) {
        for (int i = 0; i < 32768; ++i) grid.set_free({i % 32, i / 32 % 32, i / 1024});
      }
      fill(dice, grid);
      fill_clear(dice, grid);
      if (seed % 3 == 2) {
        const Sphere sphere{dice.point(3.0), dice.uniform(0.2, 1.5)};
        tree.paint(round % 2, sphere);
        slow.paint(round % 2, sphere);
      }
      const std::size_t before = tree.size();
      apply_one_by_one(slow, grid);
      tree.update(grid, Integration::safe, GetParam());
      ASSERT_EQ(tree.size(), slow.size());
      ASSERT_EQ(tree.size(), tree.calcNumNodes());
      ASSERT_EQ(bytes_of(tree), bytes_of(slow)) << "seed " << seed << " round " << round;
      forgotten += round % 3 == 1 && tree.size() > before ? 1 : 0;
    }
  }
  EXPECT_GT(forgotten, 2U);
}

TEST_P(FusedTreeUpdate, LeavesCopiesOfTheTreeAsTheyAre) {
  Dice dice(40);
  FusedTree tree(0.05);
  for (int round = 0; round < 10; ++round) {
    const FusedTree copy(tree);
    const std::string before = copy.size() > 0 ? bytes_of(copy) : "";
    ScanGrid grid;
    fill(dice, grid);
    tree.update(grid, Integration::compatible, GetParam());
    EXPECT_EQ(copy.size() > 0 ? bytes_of(copy) : "", before);
    EXPECT_NE(bytes_of(tree), before);
  }
}

TEST_P(FusedTreeUpdate, AnEmptyScanChangesNothing) {
  FusedTree tree(0.05);
  ScanGrid grid;
  tree.update(grid, Integration::compatible, GetParam());
  grid.set_free({1, 2, 3});
  grid.clear_free({1, 2, 3});
  tree.update(grid, Integration::compatible, GetParam());
  EXPECT_EQ(tree.size(), 0U);
  EXPECT_EQ(tree.getRoot(), nullptr);
}

INSTANTIATE_TEST_SUITE_P(Threads, FusedTreeUpdate, ::testing::Values(1, 2, 3));

}  // namespace fused_tree_update_test
}  // namespace clearway
