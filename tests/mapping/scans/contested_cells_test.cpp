#include "mapping/scans/contested_cells.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <map>

#include "mapping/scans/scan_rays.hpp"
#include "mapping/voxels/occupancy_update.hpp"
#include "tests/worlds/random_map.hpp"

namespace clearway {
namespace contested_cells_test {

using worlds::Dice;
using Cell = std::array<int, 3>;

/// What is known of one voxel: the slow and obvious twin.
struct Plain {
  bool observed = false;
  float log_odds = 0.0F;
  int contested = 0;
};

int draw(Dice& dice, int low, int high) { return static_cast<int>(std::floor(dice.uniform(low, high))); }

ScanGrid random_scan(Dice& dice, int corner, int edge, std::map<Cell, char>& what) {
  ScanGrid grid;
  for (int i = 0; i < 800; ++i) {
    const Cell c{corner + draw(dice, 0, edge), corner + draw(dice, 0, edge), corner + draw(dice, 0, edge)};
    const Eigen::Vector3i cell(c[0], c[1], c[2]);
    if (what.contains(c)) continue;
    const int kind = draw(dice, 0, 3);
    what[c] = "fsh"[kind];
    ScanTile& tile = grid.tile(cell);
    const unsigned bit = ScanTile::bit_of(cell);
    (kind == 0   ? tile.free
     : kind == 1 ? tile.spared
                 : tile.occupied)[bit >> 6U] |= std::uint64_t{1} << (bit & 63U);
  }
  return grid;
}

TEST(ContestedCells, WeighScansAsTheRuleOfOneVoxelSays) {
  for (unsigned seed = 0; seed < 12; ++seed) {
    Dice dice(seed);
    FusedTree tree(0.1);
    ContestedCells contested;
    const int corner = seed % 3 == 0 ? -32768 : seed % 3 == 1 ? 32768 - 12 : -6;
    std::map<Cell, Plain> plain;
    for (int scan = 0; scan < 12; ++scan) {
      std::map<Cell, char> what;
      ScanGrid grid = random_scan(dice, corner, 12, what);
      contested.weigh(tree, grid, 1 + static_cast<int>(seed % 3));
      tree.update(grid, Integration::safe);
      const OccupancyUpdate rule{Integration::safe,
                                 tree.getProbHitLog(),
                                 tree.getProbMissLog(),
                                 tree.getClampingThresMinLog(),
                                 tree.getClampingThresMaxLog(),
                                 tree.getOccupancyThresLog()};
      for (const auto& [c, kind] : what) {
        Plain& voxel = plain[c];
        const float before = voxel.observed ? voxel.log_odds : 0.0F;
        if (kind == 'h') {
          voxel = {true, rule.after_hit(before), 0};
        } else if (kind == 'f' && voxel.contested > 0) {
          --voxel.contested;
        } else if (kind == 'f') {
          voxel = {true, rule.after_miss(before), 0};
        } else if (!voxel.observed) {
          voxel.contested = std::min(2, voxel.contested + 1);
        } else if (before < rule.threshold && before > 1.5F * rule.miss) {
          voxel.observed = false;
        }
      }
      for (const auto& [c, voxel] : plain) {
        CellCube cube;
        const Eigen::Vector3i cell(c[0], c[1], c[2]);
        const FusedNode* leaf = tree.find_leaf(cell, cube);
        ASSERT_EQ(leaf != nullptr && leaf->observed(), voxel.observed) << seed << ' ' << scan;
        if (voxel.observed) {
          ASSERT_EQ(leaf->getLogOdds(), voxel.log_odds);
        } else {
          ASSERT_EQ(contested.contested(cell), voxel.contested);
        }
      }
      std::size_t nodes = 0, unknown = 0;
      tree.visit_leaves(
          [&](const FusedNode& node, const CellCube&) { unknown += node.observed() ? 0U : 1U; });
      EXPECT_EQ(unknown, 0U) << "what is taken back is not kept";
      for (auto node = tree.begin_tree(); node != tree.end_tree(); ++node) ++nodes;
      EXPECT_EQ(nodes, tree.size());
    }
  }
}

TEST(ContestedCells, TakingBackKeepsThePaint) {
  FusedTree tree(0.1);
  tree.paint(3, {Eigen::Vector3d(0.05, 0.05, 0.05), 0.6});
  const FusedTree before(tree);
  const Eigen::Vector3i cell(0, 0, 0);
  tree.set_observed(tree.coordToKey(0.05, 0.05, 0.05), -0.4F);
  tree.finish();
  CellCube cube;
  ASSERT_TRUE(tree.find_leaf(cell, cube)->observed());
  tree.take_back(cell);
  EXPECT_FALSE(tree.find_leaf(cell, cube)->observed());
  EXPECT_EQ(tree.find_leaf(cell, cube)->painted(), 1U << 3U);
  std::size_t changes = 0;
  tree.visit_changes(before, [&](const FusedNode*, const FusedNode*, const CellCube&) { ++changes; });
  EXPECT_EQ(changes, 0U) << "the tree is again what it was";
}

/// A wall at a slant, scanned again and again: what is occupied between two hits of it, where a ray passes,
/// loses evidence by every fourth scan alone; what is not between hits by each.
TEST(ContestedCells, OneLookInFourBetweenHitsCountsAgainstWhatIsOccupied) {
  Scan scan;
  for (int i = 0; i < 64; ++i) {
    const double azimuth = (5.0 + 0.5 * i) * M_PI / 180.0;
    scan.points.push_back((0.98 * Eigen::Vector3d(1.0 / std::tan(azimuth), 1.0, 0.01)).cast<float>());
  }
  FusedTree tree(0.05);
  std::vector<Eigen::Vector3i> cells;
  for (int x = 100; x < 220; ++x)
    for (int y = 16; y < 20; ++y) cells.emplace_back(x, y, 0);
  for (int x = 100; x < 220; ++x)  // a block, no layer that is seen edge-on
    for (int y = 12; y < 24; ++y)
      for (int z = -4; z <= 4; ++z) tree.occupy_voxel({x, y, z});
  const ScanInsertion insertion{.integration = Integration::safe};
  ScanWorkspace workspace;
  ScanEvidence evidence;
  std::map<std::string, int> patterns;  // of each cell: whether a scan lowered it
  std::vector<std::string> of_cells(cells.size());
  const auto log_odds = [&](const Eigen::Vector3i& cell) {
    CellCube cube;
    return tree.find_leaf(cell, cube)->getLogOdds();
  };
  for (int i = 0; i < 8; ++i) {
    for (const Eigen::Vector3i& cell : cells) tree.occupy_voxel(cell);
    insert_scan(tree, scan, {}, insertion, workspace, &evidence);
    for (std::size_t k = 0; k < cells.size(); ++k)
      of_cells[k] += log_odds(cells[k]) < tree.getClampingThresMaxLog() ? 'x' : '-';
  }
  for (const std::string& pattern : of_cells) ++patterns[pattern];
  EXPECT_GT(patterns["---x---x"], 5);
  EXPECT_GT(patterns["xxxxxxxx"], 5);
  EXPECT_EQ(patterns["---x---x"] + patterns["xxxxxxxx"] + patterns["--------"],
            static_cast<int>(cells.size()));
}

}  // namespace contested_cells_test
}  // namespace clearway
