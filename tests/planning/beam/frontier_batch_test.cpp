#include "planning/beam/frontier_batch.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <bit>
#include <map>

#include "planning/beam/node_set.hpp"
#include "planning/robot_files/load_robot.hpp"
#include "tests/worlds/random_world.hpp"
#include "tests/worlds/voxel_scene.hpp"

namespace clearway {
namespace head_group_test {

/// The sums of the least and the greatest terms of a head's joints from `first` on, last joint first.
std::pair<double, double> rest_of(const Lattice& lattice, const LatticeIndex& head, std::size_t first) {
  double least = 0.0, most = 0.0;
  for (std::size_t j = head.size(); j > first; --j) {
    std::vector<double> terms;
    for (int change = -1; change <= 1; ++change)
      terms.push_back(lattice.distance_term(static_cast<Eigen::Index>(j - 1), head[j - 1] + change));
    std::sort(terms.begin(), terms.end());
    least += terms.front(), most += terms.back();
  }
  return {least, most};
}

TEST(FrontierBatch, KnowsForEachIndexAndEachSumWhichHeadsItIsFor) {
  Random random(31);
  FrontierBatch group;
  for (const char* name : {"point", "puma560", "panda"}) {
    const Robot robot = load_robot(name);
    const ConfigurationSpace space(robot, VoxelScene{}.snapshot());
    const PathCost cost(robot);
    for (const std::size_t count : {std::size_t{1}, std::size_t{7}, FrontierBatch::most}) {
      const Lattice lattice({space, cost, random.configuration(robot), random.configuration(robot)},
                            BeamOptions{});
      std::vector<LatticeIndex> heads(count, LatticeIndex(robot.dof()));
      group.clear();
      for (LatticeIndex& head : heads) {
        for (int& index : head) index = random.below(9) - 4;
        group.add(head, lattice);
      }
      group.finish();
      EXPECT_EQ(group.size(), count);
      EXPECT_EQ(static_cast<std::size_t>(std::popcount(group.all())), count);
      for (std::size_t j = 0; j < robot.dof(); ++j) {
        std::map<int, std::uint64_t> next_to;
        for (std::size_t head = 0; head < count; ++head) {
          for (int change = -1; change <= 1; ++change)
            next_to[heads[head][j] + change] |= std::uint64_t{1} << head;
        }
        double before = -1.0;
        EXPECT_EQ(group.choices(j).size(), next_to.size());
        for (const FrontierBatch::Choice& choice : group.choices(j)) {
          EXPECT_EQ(choice.heads, next_to.at(choice.index));
          EXPECT_EQ(choice.term, lattice.distance_term(static_cast<Eigen::Index>(j), choice.index));
          EXPECT_EQ(choice.hash, NodeSet::hash_term(j, choice.index));
          EXPECT_GE(choice.term, before);
          before = choice.term;
        }
      }
      for (std::size_t j = 1; j <= robot.dof(); ++j) {
        double least_of_all = 1e300;
        for (const LatticeIndex& head : heads)
          least_of_all = std::min(least_of_all, rest_of(lattice, head, j).first);
        EXPECT_EQ(group.least_rest(j), least_of_all);
        for (int i = 0; i < 20; ++i) {  // half of them just what a head can add
          const std::size_t some = static_cast<std::size_t>(random.below(static_cast<int>(count)));
          const auto [least, most] = rest_of(lattice, heads[some], j);
          const double at_most = i % 2 == 0 ? least : random.between(0.0, 2.0 * least);
          const double at_least = i % 2 == 0 ? most : random.between(0.0, 2.0 * most);
          std::uint64_t low = 0, high = 0;
          for (std::size_t head = 0; head < count; ++head) {
            const auto rest = rest_of(lattice, heads[head], j);
            if (rest.first <= at_most) low |= std::uint64_t{1} << head;
            if (rest.second >= at_least) high |= std::uint64_t{1} << head;
          }
          EXPECT_EQ(group.that_can_add_at_most(at_most, j), low);
          EXPECT_EQ(group.that_can_add_at_least(at_least, j), high);
        }
      }
    }
  }
}

TEST(FrontierBatch, KnowsItsNearestAndItsFarthestNeighbour) {
  Random random(32);
  const Robot robot = load_robot("arm5");
  const ConfigurationSpace space(robot, VoxelScene{}.snapshot());
  const PathCost cost(robot);
  const Lattice lattice({space, cost, random.configuration(robot), random.configuration(robot)},
                        BeamOptions{});
  FrontierBatch group;
  double nearest = 1e300, farthest = 0.0;
  for (int head = 0; head < 10; ++head) {
    LatticeIndex node(5);
    for (int& index : node) index = random.below(21) - 10;
    group.add(node, lattice);
    for (int code = 0; code < 243; ++code) {
      LatticeIndex neighbour = node;
      for (int j = 0, rest = code; j < 5; ++j, rest /= 3)
        neighbour[static_cast<std::size_t>(j)] += rest % 3 - 1;
      nearest = std::min(nearest, lattice.squared_distance(neighbour));
      farthest = std::max(farthest, lattice.squared_distance(neighbour));
    }
    EXPECT_EQ(group.nearest(), nearest);
    EXPECT_EQ(group.farthest(), farthest);
  }
}

}  // namespace head_group_test
}  // namespace clearway
