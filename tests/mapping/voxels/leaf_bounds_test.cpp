// Bounds that follow a map against those of all of its leaves.

#include "mapping/voxels/leaf_bounds.hpp"

#include <gtest/gtest.h>

#include "mapping/free_space_map.hpp"
#include "mapping/voxels/fused_tree.hpp"
#include "tests/worlds/random_map.hpp"

namespace clearway {
namespace leaf_bounds_test {

using worlds::Dice;

Eigen::AlignedBox3i bounds_of_leaves(const FusedTree& tree) {
  Eigen::AlignedBox3i bounds;
  tree.visit_leaves([&](const FusedNode&, const CellCube& cube) {
    bounds.extend(cube.corner);
    bounds.extend(cube.corner + Eigen::Vector3i::Constant(cube.edge));
  });
  return bounds;
}

void expect_same(const Eigen::AlignedBox3i& a, const Eigen::AlignedBox3i& b) {
  EXPECT_EQ(a.isEmpty(), b.isEmpty());
  if (a.isEmpty()) return;
  EXPECT_EQ(a.min(), b.min());
  EXPECT_EQ(a.max(), b.max());
}

// Spheres that come far out and go again: the bounds grow and shrink, by undone strokes, too.
TEST(LeafBounds, FollowScansPaintAndWhatIsUndone) {
  int grew = 0, shrank = 0;
  for (unsigned seed = 0; seed < 6; ++seed) {
    Dice dice(seed);
    FreeSpaceMap map({.resolution = 0.05});
    map.add_volume("volume", {});
    Snapshot before = map.snapshot();
    Eigen::AlignedBox3i known;
    for (int step = 0; step < 40; ++step) {
      const int kind = dice.whole(0, 3);
      if (kind == 0) {
        map.insert(worlds::random_scan(dice, 20));
      } else if (kind == 1) {
        map.undo_stroke();
      } else {
        map.begin_stroke("a stroke");
        map.paint(0, {dice.point(3.0), dice.uniform(0.05, 0.3)});
      }
      const Snapshot now = map.snapshot();
      const Eigen::AlignedBox3i expected = bounds_of_leaves(now.tree());
      expect_same(leaf_bounds(now.tree()), expected);
      const Eigen::AlignedBox3i followed = leaf_bounds(now.tree(), before.tree(), known);
      expect_same(followed, expected);
      grew += !known.contains(followed);
      shrank += !followed.contains(known);
      if (!now.bounds().isEmpty()) {  // the same, from one snapshot to the next
        EXPECT_EQ(now.bounds().min(), Eigen::Vector3d(expected.min().cast<double>() * 0.05));
        EXPECT_EQ(now.bounds().max(), Eigen::Vector3d(expected.max().cast<double>() * 0.05));
      }
      known = followed;
      before = now;
    }
  }
  EXPECT_GT(grew, 10);
  EXPECT_GT(shrank, 5);
}

TEST(LeafBounds, AreThoseOfTheOtherTreeWhereNothingIsShared) {
  const Snapshot a = worlds::random_map(1, 0.05).snapshot(), b = worlds::random_map(2, 0.05).snapshot();
  expect_same(leaf_bounds(b.tree(), a.tree(), leaf_bounds(a.tree())), bounds_of_leaves(b.tree()));
  const FusedTree empty(0.05);
  expect_same(leaf_bounds(a.tree(), empty, leaf_bounds(empty)), bounds_of_leaves(a.tree()));
  expect_same(leaf_bounds(empty, a.tree(), leaf_bounds(a.tree())), bounds_of_leaves(empty));
}

}  // namespace leaf_bounds_test
}  // namespace clearway
