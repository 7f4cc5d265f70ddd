#include "mapping/voxels/fused_tree.hpp"

#include <gtest/gtest.h>
#include <octomap/OcTree.h>

#include <cstring>
#include <map>
#include <sstream>
#include <tuple>

#include "tests/worlds/random_map.hpp"

namespace clearway {
namespace fused_tree_test {

using worlds::Dice;

octomap::OcTreeKey key_of(const FusedTree& tree, const Eigen::Vector3d& point) {
  octomap::OcTreeKey key;
  EXPECT_TRUE(tree.coordToKeyChecked(point.x(), point.y(), point.z(), key));
  return key;
}

/// All that a tree says about each of its voxels, whatever its pruning.
using Cells = std::map<std::tuple<int, int, int>, std::tuple<float, int, bool>>;
Cells cells_of(const FusedTree& tree) {
  Cells cells;
  tree.visit_leaves([&](const FusedNode& node, const CellCube& cube) {
    for (int x = 0; x < cube.edge; ++x) {
      for (int y = 0; y < cube.edge; ++y) {
        for (int z = 0; z < cube.edge; ++z) {
          cells[{cube.corner.x() + x, cube.corner.y() + y, cube.corner.z() + z}] = {
              node.getLogOdds(), node.painted(), node.observed()};
        }
      }
    }
  });
  return cells;
}

FusedTree random_tree(unsigned seed) {
  const FreeSpaceMap map = worlds::random_map(seed);
  return FusedTree(map.snapshot().tree());
}

void expect_consistent(const FusedTree& tree, const FusedNode& node) {
  if (!tree.nodeHasChildren(&node)) {
    EXPECT_TRUE(node.observed() || node.painted() != 0);
    if (!node.observed()) {
      EXPECT_EQ(node.getLogOdds(), FusedNode::unobserved_log_odds);
    }
    return;
  }
  EXPECT_FALSE(tree.isNodeCollapsible(&node));
  unsigned common = 0xffff;
  float highest = -1e9F;
  bool observed = false;
  for (unsigned i = 0; i < 8; ++i) {
    const FusedNode* child = tree.nodeChildExists(&node, i) ? tree.getNodeChild(&node, i) : nullptr;
    common &= child == nullptr ? 0U : child->painted();
    if (child == nullptr) continue;
    expect_consistent(tree, *child);
    observed = observed || child->observed();
    if (child->observed()) highest = std::max(highest, child->getLogOdds());
  }
  EXPECT_EQ(node.painted(), common);
  EXPECT_EQ(node.observed(), observed);
  EXPECT_EQ(node.getLogOdds(), observed ? highest : FusedNode::unobserved_log_odds);
}

TEST(FusedTree, ANodeCostsNoMoreBytesThanAStockNode) {
  EXPECT_EQ(sizeof(FusedNode), sizeof(octomap::OcTreeNode));
}

TEST(FusedTree, InnerNodesHoldTheMaximumOfObservedChildrenAndTheCommonPaint) {
  for (unsigned seed = 0; seed < 10; ++seed) {
    const FusedTree tree = random_tree(seed);
    expect_consistent(tree, *tree.getRoot());
    EXPECT_EQ(tree.size(), tree.calcNumNodes());
  }
}

TEST(FusedTree, ACopyIsEqualAndIndependent) {
  FusedTree tree = random_tree(1);
  const FusedTree copy(tree);
  EXPECT_TRUE(copy == tree);
  EXPECT_EQ(cells_of(copy), cells_of(tree));
  const Cells before = cells_of(copy);
  tree.paint(3, {Eigen::Vector3d::Zero(), 0.5});
  EXPECT_FALSE(copy == tree);
  EXPECT_EQ(cells_of(copy), before);
}

FusedTree coarse_tree(unsigned seed) {
  FreeSpaceMap map({.resolution = 0.2});
  map.add_volume("v", {});
  Dice dice(seed);
  for (int i = 0; i < 3; ++i) {
    map.insert(worlds::random_scan(dice, 50));
    map.paint(0, {dice.point(0.5), 0.9});
  }
  return FusedTree(map.snapshot().tree());
}

TEST(FusedTree, ExpandingAndPruningKeepMasksAndLogOdds) {
  for (unsigned seed = 0; seed < 5; ++seed) {
    FusedTree tree = coarse_tree(seed);
    const FusedTree before = coarse_tree(seed);
    for (int i = 0; i < 3; ++i) {  // one level at a time: whole expansion of the root would not fit memory
      std::vector<FusedNode*> coarse;
      for (auto it = tree.begin_leafs(), end = tree.end_leafs(); it != end; ++it) {
        if (it.getDepth() < 16) coarse.push_back(&*it);
      }
      for (FusedNode* node : coarse) tree.expandNode(node);
    }
    EXPECT_EQ(cells_of(tree), cells_of(before));
    tree.prune();
    EXPECT_TRUE(tree == before);
  }
}

TEST(FusedTree, CopiesStayAsTheyWereWhileTheOriginalIsWritten) {
  for (unsigned seed = 0; seed < 3; ++seed) {
    Dice dice(seed);
    FreeSpaceMap map({.resolution = 0.05});
    map.add_volume("v", {});
    std::vector<Snapshot> copies;
    std::vector<Cells> expected;
    for (int i = 0; i < 12; ++i) {
      if (i % 2 == 0) map.insert(worlds::random_scan(dice, 100));
      if (i % 3 != 1) map.paint(0, worlds::random_sphere(dice));
      copies.push_back(map.snapshot());
      expected.push_back(cells_of(copies.back().tree()));
      if (i % 4 == 3) {  // some go away early, out of order
        copies.erase(copies.end() - 2);
        expected.erase(expected.end() - 2);
      }
    }
    for (std::size_t i = 0; i < copies.size(); ++i) {
      EXPECT_EQ(cells_of(copies[i].tree()), expected[i]);
      EXPECT_EQ(copies[i].tree().size(), copies[i].tree().calcNumNodes());
    }
  }
}

TEST(FusedTree, MoreCopiesMayLiveThanOwnersCanBeCounted) {
  FreeSpaceMap map({.resolution = 0.1});
  map.add_volume("v", {});
  Dice dice(3);
  map.insert(worlds::random_scan(dice, 200));
  const Cells first = cells_of(map.snapshot().tree());
  std::vector<Snapshot> copies;
  for (int i = 0; i < 1000; ++i) {
    copies.push_back(map.snapshot());
    map.paint(0, {dice.point(0.7), 0.12});
  }
  EXPECT_EQ(cells_of(copies.front().tree()), first);
  const Cells last = cells_of(map.snapshot().tree());
  while (copies.size() > 1) copies.erase(copies.begin());
  EXPECT_EQ(cells_of(map.snapshot().tree()), last);
  EXPECT_EQ(map.snapshot().tree().size(), map.snapshot().tree().calcNumNodes());
}

TEST(FusedTree, ChangesBetweenVersionsAreExactlyWhatDiffers) {
  for (unsigned seed = 0; seed < 5; ++seed) {
    Dice dice(seed);
    FreeSpaceMap map({.resolution = 0.05});
    map.add_volume("v", {});
    Snapshot before = map.snapshot();
    std::size_t visited = 0;
    for (int i = 0; i < 6; ++i) {
      if (i % 2 == 0) map.insert(worlds::random_scan(dice, 60));
      if (i % 2 == 1) map.paint(0, worlds::random_sphere(dice));
      const Snapshot now = map.snapshot();
      Cells patched = cells_of(before.tree());
      now.tree().visit_changes(
          before.tree(), [&](const FusedNode* was, const FusedNode* is, const CellCube& cube) {
            ++visited;
            ASSERT_TRUE(was == nullptr || is == nullptr || !(*was == *is));
            for (int x = 0; x < cube.edge; ++x) {
              for (int y = 0; y < cube.edge; ++y) {
                for (int z = 0; z < cube.edge; ++z) {
                  const std::tuple cell(cube.corner.x() + x, cube.corner.y() + y, cube.corner.z() + z);
                  ASSERT_EQ(patched.count(cell) != 0, was != nullptr);
                  patched.erase(cell);
                  if (is != nullptr) patched[cell] = {is->getLogOdds(), is->painted(), is->observed()};
                }
              }
            }
          });
      EXPECT_EQ(patched, cells_of(now.tree()));
      before = now;
    }
    EXPECT_GT(visited, 100U);
    map.snapshot().tree().visit_changes(
        before.tree(), [&](const FusedNode*, const FusedNode*, const CellCube&) { ADD_FAILURE(); });
  }
}

TEST(FusedTree, VoxelsWithDifferentPaintAreNotMerged) {
  FusedTree tree(1.0);
  tree.paint(0, {{4.0, 4.0, 4.0}, 7.0});  // the cube 0..8 lies inside
  const std::size_t merged = tree.size();
  tree.paint(1, {{0.5, 0.5, 0.5}, 0.9});  // one voxel of it
  EXPECT_GT(tree.size(), merged);
  CellCube cube;
  EXPECT_EQ(tree.find_leaf({0, 0, 0}, cube)->painted(), 3);
  EXPECT_EQ(cube.edge, 1);
  EXPECT_EQ(tree.find_leaf({1, 0, 0}, cube)->painted(), 1);
}

TEST(FusedTree, StockCodeDoesNotTakeAPaintedVoxelForAnObstacle) {
  FusedTree tree(0.1);
  tree.paint(0, {Eigen::Vector3d::Zero(), 1.0});
  for (auto it = tree.begin_leafs(), end = tree.end_leafs(); it != end; ++it)
    EXPECT_FALSE(tree.isNodeOccupied(*it));
  octomap::point3d hit;
  EXPECT_FALSE(tree.castRay({0, 0, 0}, {1, 0, 0}, hit, true, 0.8));
}

TEST(FusedTree, TheFirstObservationOfAPaintedVoxelStartsFromEvenOdds) {
  for (const bool hit : {true, false}) {
    FusedTree painted(0.1), plain(0.1);
    painted.paint(0, {Eigen::Vector3d::Zero(), 1.0});
    const auto key = key_of(painted, {0.01, 0.01, 0.01});
    for (int i = 0; i < 12; ++i) {  // into clamping, where stock code returns early
      painted.updateNode(key, hit);
      plain.updateNode(key, hit);
      ASSERT_EQ(painted.search(key)->getLogOdds(), plain.search(key)->getLogOdds());
    }
    EXPECT_TRUE(painted.search(key)->observed());
    EXPECT_EQ(painted.search(key)->painted(), 1);
    EXPECT_EQ(painted.state(*painted.search(key)), hit ? VoxelState::conflict : VoxelState::painted);
  }
}

TEST(FusedTree, OctoMapsRegistryReadsBackWhatItsWriterWrote) {
  FusedTree::register_type();
  const FusedTree tree = random_tree(3);
  std::stringstream stream;
  ASSERT_TRUE(tree.write(stream));
  ::testing::internal::CaptureStderr();
  const std::unique_ptr<octomap::AbstractOcTree> read(octomap::AbstractOcTree::read(stream));
  ::testing::internal::GetCapturedStderr();
  const auto* fused = dynamic_cast<const FusedTree*>(read.get());
  ASSERT_NE(fused, nullptr);
  EXPECT_EQ(cells_of(*fused), cells_of(tree));
}

TEST(FusedNode, IsPrunedOnlyWhenItsChildrenAreEightEqualLeaves) {
  for (unsigned odd = 0; odd < 8; ++odd) {
    auto* const node = new FusedNode;
    node->observe(1.5F);
    std::size_t nodes = 1;
    bool created = false;
    FusedNode& child = node->child_for_writing(odd, false, created, nodes);
    child.child_for_writing(odd, false, created, nodes).add_paint(1);
    EXPECT_FALSE(node->prune(nodes)) << "child " << odd << " has children";
    EXPECT_EQ(nodes, 17U);
    child.drop_children();
    nodes -= 8;
    child.add_paint(1);
    EXPECT_FALSE(node->prune(nodes)) << "child " << odd << " is painted";
    child.remove_paint(1);
    EXPECT_TRUE(node->prune(nodes)) << odd;
    EXPECT_EQ(nodes, 1U);
    EXPECT_FALSE(node->has_children());
    EXPECT_EQ(node->getLogOdds(), 1.5F);
    FusedNode::release(node);
  }
}

TEST(FusedTree, FindsTheSameLeafAsOctoMapsSearch) {
  const FusedTree tree = random_tree(4);
  Dice dice(4);
  for (int i = 0; i < 20000; ++i) {
    const Eigen::Vector3d point = dice.point(1.5);
    CellCube cube;
    const FusedNode* leaf = tree.find_leaf(*tree.cell(point), cube);
    ASSERT_EQ(leaf, tree.search(key_of(tree, point)));
    if (leaf == nullptr) continue;
    ASSERT_TRUE(((*tree.cell(point) - cube.corner).array() < cube.edge).all());
  }
}

TEST(FusedTree, NoCellForWhatOctoMapWouldWrap) {
  const FusedTree tree(0.01);
  const double nan = std::nan("");
  for (const double bad : {nan, HUGE_VAL, -HUGE_VAL, 327.681, -327.681, 1e300, 42949672.96 * 0.01 * 100}) {
    EXPECT_FALSE(tree.cell({0.0, bad, 0.0})) << bad;
  }
  EXPECT_EQ(tree.cell({-327.68, 0.0, 327.675}), Eigen::Vector3i(-32768, 0, 32767));
}

TEST(FusedTree, VisitingABoxVisitsTheLeavesThatOverlapItAndNoOthers) {
  const FusedTree tree = random_tree(5);
  const Eigen::Vector3i first(-7, -3, 0), last(4, 9, 5);
  std::vector<const FusedNode*> expected, found;
  tree.visit_leaves([&](const FusedNode& node, const CellCube& cube) {
    const bool before = (cube.corner.array() + cube.edge - 1 < first.array()).any();
    if (!before && (cube.corner.array() <= last.array()).all()) expected.push_back(&node);
  });
  tree.visit_leaves(first, last, [&](const FusedNode& node, const CellCube&) { found.push_back(&node); });
  EXPECT_FALSE(expected.empty());
  EXPECT_EQ(found, expected);
}

}  // namespace fused_tree_test
}  // namespace clearway
