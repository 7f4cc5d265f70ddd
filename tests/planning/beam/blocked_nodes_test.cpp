#include "planning/beam/blocked_nodes.hpp"

#include <gtest/gtest.h>

namespace clearway {
namespace closed_nodes_test {

/// As an enumeration that adds joint to joint asks.
bool is_closed(const BlockedNodes& closed, const LatticeIndex& node) {
  std::uint64_t hash = 0;
  for (std::size_t first = 0; first <= node.size(); ++first) {
    if (closed.is_closed(node.data(), first, hash)) return true;
    if (first < node.size()) hash += NodeSet::hash_term(first, node[first]);
  }
  return false;
}

TEST(BlockedNodes, BlockedFirstJointsCloseAllNodesThatBeginSoAndVisitedOnesAreClosedAlone) {
  NodeSet visited(4);
  BlockedNodes closed(4, visited);
  closed.block(LatticeIndex{1, -2, 9, 9}.data(), 2, 100);
  visited.insert({0, 0, 0, 1});
  EXPECT_TRUE(is_closed(closed, {1, -2, 9, 9}));
  EXPECT_TRUE(is_closed(closed, {1, -2, 0, 5}));
  EXPECT_FALSE(is_closed(closed, {1, -1, 9, 9}));
  EXPECT_TRUE(is_closed(closed, {0, 0, 0, 1}));
  EXPECT_FALSE(is_closed(closed, {0, 0, 0, 2}));
  EXPECT_TRUE(closed.is_blocked({1, -2, 0, 5}));
  EXPECT_FALSE(closed.is_blocked({0, 0, 0, 1}));
}

TEST(BlockedNodes, BeyondItsBoundItForgetsWhatIsBlockedAndKeepsWhatWasVisited) {
  NodeSet visited(2);
  visited.insert({7, 7});
  BlockedNodes closed(2, visited);
  for (int i = 0; i < 10; ++i) closed.block(LatticeIndex{i, 0}.data(), i % 2 == 0 ? 1 : 2, 10);
  for (int i = 0; i < 10; ++i) EXPECT_TRUE(is_closed(closed, {i, 0})) << i;
  closed.block(LatticeIndex{10, 0}.data(), 2, 10);
  EXPECT_FALSE(is_closed(closed, {3, 0}));
  EXPECT_TRUE(is_closed(closed, {10, 0}));
  EXPECT_TRUE(is_closed(closed, {7, 7}));
}

TEST(BlockedNodes, WhenNoJointMattersOneBlockedNodeClosesAll) {
  NodeSet visited(3);
  BlockedNodes closed(3, visited);
  EXPECT_FALSE(is_closed(closed, {0, 1, 2}));
  closed.block(LatticeIndex{5, 5, 5}.data(), 0, 10);
  EXPECT_TRUE(is_closed(closed, {0, 1, 2}));
}

}  // namespace closed_nodes_test
}  // namespace clearway
