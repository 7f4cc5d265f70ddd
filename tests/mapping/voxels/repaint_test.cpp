// Repainting against a tree that was painted with the remaining spheres alone.

#include <gtest/gtest.h>

#include "mapping/voxels/fused_tree.hpp"
#include "tests/worlds/random_map.hpp"

namespace clearway {
namespace repaint_test {

using worlds::Dice;

/// Some spheres, many of them meeting at a corner of many cubes of the tree.
std::vector<Sphere> random_spheres(Dice& dice, int count) {
  std::vector<Sphere> spheres;
  for (int i = 0; i < count; ++i) spheres.push_back({dice.point(0.5), dice.uniform(0.02, 0.4)});
  return spheres;
}

FusedTree seen_tree(unsigned seed) { return worlds::random_map(seed, 0.04, 3, 100).snapshot().tree(); }

TEST(Repaint, LeavesTheTreeThatOnlyTheRemainingSpheresPainted) {
  std::size_t unpainted = 0, painted = 0;
  for (unsigned seed = 0; seed < 60; ++seed) {
    Dice dice(seed);
    FusedTree tree = seed % 3 == 0 ? FusedTree(0.04) : seen_tree(seed);
    FusedTree expected(tree);
    const std::vector<Sphere> kept = random_spheres(dice, dice.whole(0, 12));
    const std::vector<Sphere> gone = random_spheres(dice, dice.whole(1, 6));
    const std::vector<Sphere> come = random_spheres(dice, dice.whole(0, 3));
    for (const Sphere& sphere : kept) tree.paint(4, sphere);
    for (const Sphere& sphere : gone) tree.paint(4, sphere);
    const FusedTree before(tree);
    std::vector<Sphere> changed = gone, spheres = kept;
    changed.insert(changed.end(), come.begin(), come.end());
    spheres.insert(spheres.end(), come.begin(), come.end());
    const RepaintTally tally = tree.repaint(4, changed, spheres);
    unpainted += tally.unpainted;
    painted += tally.painted;

    for (const Sphere& sphere : spheres) expected.paint(4, sphere);
    EXPECT_TRUE(tree == expected) << seed;
    EXPECT_EQ(tree.size(), expected.size());
    EXPECT_EQ(tree.size(), tree.calcNumNodes());
    FusedTree again = seed % 3 == 0 ? FusedTree(0.04) : seen_tree(seed);
    for (const Sphere& sphere : kept) again.paint(4, sphere);
    for (const Sphere& sphere : gone) again.paint(4, sphere);
    EXPECT_TRUE(before == again) << "a copy changed with the original";
  }
  EXPECT_GT(unpainted, 1000U);
  EXPECT_GT(painted, 1000U);
}

TEST(Repaint, WithoutSpheresLeavesNothingInATreeThatNoSensorSaw) {
  FusedTree tree(0.05);
  const Sphere sphere{{1.0, 2.0, 3.0}, 0.7};
  const std::size_t painted = tree.paint(2, sphere).painted;
  EXPECT_EQ(tree.repaint(2, {sphere}, {}).unpainted, painted);
  EXPECT_EQ(tree.getRoot(), nullptr);
  EXPECT_EQ(tree.size(), 0U);
  EXPECT_EQ(tree.repaint(2, {sphere}, {}).unpainted, 0U);
  EXPECT_EQ(tree.repaint(2, {}, {sphere}).painted, 0U);  // nowhere to look
}

TEST(Repaint, LeavesOtherVolumesAndSensorsAlone) {
  FusedTree tree = seen_tree(5);
  const Sphere mine{{0.1, 0.1, 0.1}, 0.3}, theirs{{0.2, 0.1, 0.1}, 0.3};
  tree.paint(3, theirs);
  const FusedTree before(tree);
  tree.paint(9, mine);
  tree.repaint(9, {mine}, {});
  EXPECT_TRUE(tree == before);
}

TEST(Repaint, CutsAHoleIntoACubeThatOneLeafStandsFor) {
  FusedTree tree(1.0);
  const Sphere all{{16.0, 16.0, 16.0}, 30.0}, left{{4.0, 4.0, 4.0}, 7.0};
  const std::size_t painted = tree.paint(0, all).painted;
  const RepaintTally tally = tree.repaint(0, {all, left}, {left});
  FusedTree expected(1.0);
  EXPECT_EQ(expected.paint(0, left).painted, painted - tally.unpainted);
  EXPECT_TRUE(tree == expected);
}

}  // namespace repaint_test
}  // namespace clearway
