#include "planning/beam/node_set.hpp"

#include <gtest/gtest.h>

#include <set>

#include "tests/worlds/random_world.hpp"

namespace clearway {
namespace node_set_test {

TEST(NodeSet, HoldsWhatASortedSetHolds) {
  Random random(3);
  for (const int joints : {1, 2, 6, 10}) {
    NodeSet nodes(static_cast<std::size_t>(joints));
    std::set<LatticeIndex> sorted;
    for (int round = 0; round < 2; ++round) {
      for (int i = 0; i < 20'000; ++i) {
        LatticeIndex node(static_cast<std::size_t>(joints));
        for (int& index : node) index = random.below(joints < 3 ? 300 : 8) - (joints < 3 ? 150 : 4);
        EXPECT_EQ(nodes.contains(node), sorted.contains(node));
        if (i % 2 == 0) {
          EXPECT_EQ(nodes.insert(node), sorted.insert(node).second);
        }
        ASSERT_EQ(nodes.size(), sorted.size());
      }
      for (const LatticeIndex& node : sorted) ASSERT_TRUE(nodes.contains(node));
      nodes.clear();
      sorted.clear();
    }
  }
}

TEST(NodeSet, NodesThatDifferInTheirLastJointAloneAreDifferent) {
  NodeSet nodes(7);
  for (int last = -1000; last <= 1000; ++last) EXPECT_TRUE(nodes.insert({0, 0, 0, 0, 0, 0, last}));
  EXPECT_EQ(nodes.size(), 2001u);
  EXPECT_FALSE(nodes.contains({0, 0, 0, 0, 0, 1, 0}));
}

}  // namespace node_set_test
}  // namespace clearway
