// The nearest point against a plain loop over all points, ties included, with each kind of registers.

#include "planning/sampling/nearest_nodes.hpp"

#include <gtest/gtest.h>

#include "tests/worlds/instruction_sets.hpp"
#include "tests/worlds/random_map.hpp"

namespace clearway {
namespace nearest_nodes_test {

/// On a coarse grid, so that many are equally far from others.
Eigen::VectorXd draw(worlds::Dice& dice, std::size_t dimensions) {
  Eigen::VectorXd point(static_cast<Eigen::Index>(dimensions));
  for (double& x : point) x = dice.whole(-3, 3) / 8.0;
  return point;
}

std::size_t nearest_by_a_loop(const std::vector<Eigen::VectorXd>& points, const Eigen::VectorXd& to) {
  std::size_t best = 0;
  for (std::size_t i = 1; i < points.size(); ++i)
    if ((points[i] - to).squaredNorm() < (points[best] - to).squaredNorm()) best = i;
  return best;
}

TEST(NearestNodes, TheEarliestOfTheNearestIsFoundByAllRegisters) {
  worlds::Dice dice(3);
  int ties = 0;
  for (const std::size_t dimensions : {1U, 2U, 6U, 7U, 9U}) {
    NearestNodes table(dimensions);
    std::vector<Eigen::VectorXd> points;
    for (int i = 0; i < 150; ++i) {
      points.push_back(draw(dice, dimensions));
      table.add(points.back());
      ASSERT_EQ(table.size(), points.size());
      const Eigen::VectorXd to = draw(dice, dimensions);
      const std::size_t expected = nearest_by_a_loop(points, to);
      for (std::size_t later = expected + 1; later < points.size(); ++later)
        ties += (points[later] - to).squaredNorm() == (points[expected] - to).squaredNorm();
      EXPECT_EQ(table.nearest(to), expected);
      for (const InstructionSet vectors : worlds::instruction_sets())
        EXPECT_EQ(table.nearest(to, vectors), expected);
    }
  }
  EXPECT_GT(ties, 500);
}

}  // namespace nearest_nodes_test
}  // namespace clearway
