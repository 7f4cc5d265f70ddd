#include "planning/neighbour_queue.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <tuple>

#include "tests/planning/random_world.hpp"
#include "voxel_scene.hpp"

namespace clearway {
namespace {

using Popped = std::tuple<double, int, LatticeIndex>;

std::vector<Popped> all_of(NeighbourQueue& queue) {
  std::vector<Popped> all;
  while (!queue.empty()) {
    const double next = queue.next_squared_distance();
    const Neighbour neighbour = queue.pop();
    EXPECT_EQ(neighbour.squared_distance, next);
    if (!all.empty()) {
      EXPECT_GE(next, std::get<0>(all.back()));
    }
    all.emplace_back(neighbour.squared_distance, neighbour.head, neighbour.node);
  }
  return all;
}

std::vector<Popped> by_brute_force(const Lattice& lattice, const std::vector<LatticeIndex>& heads) {
  std::vector<Popped> all;
  for (std::size_t head = 0; head < heads.size(); ++head) {
    std::size_t count = 1;
    for (std::size_t j = 0; j < heads[head].size(); ++j) count *= 3;
    for (std::size_t code = 0; code < count; ++code) {
      LatticeIndex node = heads[head];
      std::size_t rest = code;
      for (int& index : node) index += static_cast<int>(rest % 3) - 1, rest /= 3;
      all.emplace_back(lattice.squared_distance(node), static_cast<int>(head), node);
    }
  }
  std::sort(all.begin(), all.end());
  return all;
}

TEST(NeighbourQueue, GivesAllNeighboursOfAllHeadsInOrderWhateverTheBand) {
  Random random(8);
  for (const char* name : {"point", "arm5", "puma560", "panda"}) {
    const Robot robot = load_robot(name);
    const ConfigurationSpace space(robot, VoxelScene{}.snapshot());
    const PathCost cost(robot);
    for (int i = 0; i < 6; ++i) {
      const Configuration start = random.configuration(robot);
      const Configuration goal = i == 0 ? start : random.configuration(robot);  // 0: every distance ties
      const Lattice lattice({space, cost, start, goal}, BeamOptions{});
      std::vector<LatticeIndex> heads;
      for (int head = 0; head < 4; ++head) {
        heads.emplace_back(robot.dof());
        for (int& index : heads.back()) index = random.below(21) - 10;
      }
      const std::vector<Popped> expected = by_brute_force(lattice, heads);
      for (const double band : {0.0, 1e-30, 1e-3, 1e3}) {
        NeighbourQueue queue(lattice, band);
        for (std::size_t head = 0; head < heads.size(); ++head)
          queue.add_head(static_cast<int>(head), heads[head]);
        std::vector<Popped> popped = all_of(queue);
        std::sort(popped.begin(), popped.end());
        EXPECT_TRUE(popped == expected) << name << " query " << i << " band " << band;
      }
    }
  }
}

TEST(NeighbourQueue, ItsBandIsHowFarTheLastOneWasBeyondTheFirst) {
  const Robot robot = load_robot("arm5");
  const ConfigurationSpace space(robot, VoxelScene{}.snapshot());
  const PathCost cost(robot);
  const Lattice lattice({space, cost, Configuration::Zero(5), Configuration::Constant(5, 0.5)},
                        BeamOptions{});
  NeighbourQueue queue(lattice);
  queue.add_head(0, LatticeIndex(5, 0));
  const double first = queue.pop().squared_distance;
  EXPECT_EQ(queue.band(), 0.0);
  double last = first;
  for (int i = 0; i < 100; ++i) last = queue.pop().squared_distance;
  EXPECT_EQ(queue.band(), last - first);
}

}  // namespace
}  // namespace clearway
