#include "planning/beam/neighbour_queue.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <set>
#include <tuple>

#include "planning/planner_table.hpp"
#include "planning/robot_files/load_robot.hpp"
#include "tests/worlds/random_world.hpp"
#include "tests/worlds/voxel_scene.hpp"

namespace clearway {
namespace neighbour_queue_test {

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
    EXPECT_TRUE(std::is_sorted(neighbour.heads.begin(), neighbour.heads.end()));
    for (const int head : neighbour.heads) all.emplace_back(neighbour.squared_distance, head, neighbour.node);
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

TEST(NeighbourQueue, GivesAllNeighboursOfMoreHeadsThanFitIntoAWord) {
  Random random(12);
  const Robot robot = load_robot("arm5");
  const ConfigurationSpace space(robot, VoxelScene{}.snapshot());
  const PathCost cost(robot);
  const Lattice lattice({space, cost, random.configuration(robot), random.configuration(robot)},
                        BeamOptions{});
  for (const int spread : {3, 60}) {  // heads that share most neighbours, or few
    std::vector<LatticeIndex> heads(150, LatticeIndex(5));
    NeighbourQueue queue(lattice);
    for (std::size_t head = 0; head < heads.size(); ++head) {
      for (int& index : heads[head]) index = random.below(spread);
      queue.add_head(static_cast<int>(head), heads[head]);
    }
    std::vector<Popped> popped = all_of(queue);
    std::sort(popped.begin(), popped.end());
    EXPECT_TRUE(popped == by_brute_force(lattice, heads)) << spread;
  }
}

TEST(NeighbourQueue, GivesANodeOnceWithAllItsHeadsAndLeavesOffWhatIsClosed) {
  Random random(9);
  const Robot robot = load_robot("puma560");
  const ConfigurationSpace space(robot, VoxelScene{}.snapshot());
  const PathCost cost(robot);
  for (int i = 0; i < 8; ++i) {
    const Lattice lattice({space, cost, random.configuration(robot), random.configuration(robot)},
                          BeamOptions{});
    std::vector<LatticeIndex> heads(5, LatticeIndex(6));
    NodeSet visited(6);
    BlockedNodes closed(6, visited);
    const auto near_node = [&] {
      LatticeIndex node(6);
      for (int& index : node) index = random.below(5) - 2;
      return node;
    };
    for (LatticeIndex& head : heads) {
      for (int& index : head) index = random.below(3) - 1;
    }
    std::set<LatticeIndex> blocked;  // nodes, and what nodes begin with
    for (int k = 0; k < 400; ++k) {
      LatticeIndex node = near_node();
      visited.insert(node);
      blocked.insert(node);
      const std::size_t first = 3 + static_cast<std::size_t>(random.below(4));
      node = near_node();
      closed.block(node.data(), first, 1000);
      blocked.insert(LatticeIndex(node.begin(), node.begin() + static_cast<std::ptrdiff_t>(first)));
    }
    const auto is_closed = [&](const LatticeIndex& node) {
      for (std::ptrdiff_t first = 1; first <= 6; ++first)
        if (blocked.contains(LatticeIndex(node.begin(), node.begin() + first))) return true;
      return false;
    };
    std::vector<Popped> expected = by_brute_force(lattice, heads);
    const auto all = static_cast<std::ptrdiff_t>(expected.size());
    std::erase_if(expected, [&](const Popped& popped) { return is_closed(std::get<2>(popped)); });
    EXPECT_LT(static_cast<std::ptrdiff_t>(expected.size()), all - 500);
    NeighbourQueue queue(lattice, 0.0, &closed);
    for (int run = 0; run < 2; ++run) {  // the second time from memory that is there
      queue.restart(run * 1e-3);
      for (int head = 0; head < 5; ++head) queue.add_head(head, heads[static_cast<std::size_t>(head)]);
      std::set<LatticeIndex> seen;
      std::vector<Popped> popped;
      Neighbour neighbour;
      while (!queue.empty()) {
        queue.pop(neighbour);
        EXPECT_TRUE(seen.insert(neighbour.node).second);
        EXPECT_FALSE(visited.contains(neighbour.node) || closed.is_blocked(neighbour.node));
        for (const int head : neighbour.heads)
          popped.emplace_back(neighbour.squared_distance, head, neighbour.node);
      }
      EXPECT_EQ(queue.popped(), popped.size());
      std::sort(popped.begin(), popped.end());
      EXPECT_TRUE(popped == expected) << i;
    }
  }
}

/// So many joints one after the other, about z and y in turn, 2 cm apart, each with a sphere.
Robot long_chain(int joints) {
  Robot robot;
  robot.name = "chain";
  robot.links.emplace_back();
  for (int j = 0; j < joints; ++j) {
    Joint& joint = robot.joints.emplace_back();
    joint.name = "joint " + std::to_string(j);
    joint.axis = j % 2 == 0 ? Eigen::Vector3d::UnitZ() : Eigen::Vector3d::UnitY();
    joint.lower = -3.0, joint.upper = 3.0;
    Link& link = robot.links.emplace_back();
    link.name = joint.name;
    link.parent = j;
    link.joint = j;
    link.parent_from_link.translation().x() = 0.02;
    Body& body = robot.bodies.emplace_back();
    body.part = "chain";
    body.link = j + 1;
    body.shape = Shape::sphere(0.005);
    body.cover = {{Eigen::Vector3d::Zero(), 0.005}};
  }
  robot.tip_link = joints;
  return robot;
}

TEST(NeighbourQueue, GivesTheNearestNeighboursOfFortyJointsAsAHeapOfRanksDoes) {
  Random random(10);
  constexpr int joints = 40;
  const Robot robot = long_chain(joints);
  const ConfigurationSpace space(robot, VoxelScene{}.snapshot(), {.critical_by_default = false});
  const PathCost cost(robot);
  for (int i = 0; i < 4; ++i) {
    const Lattice lattice({space, cost, random.configuration(robot), random.configuration(robot)},
                          BeamOptions{});
    LatticeIndex head(joints);
    for (int& index : head) index = random.below(5) - 2;
    std::vector<std::array<LatticeIndex::value_type, 3>> choices(joints);  // nearest first
    for (int j = 0; j < joints; ++j) {
      const auto at = static_cast<std::size_t>(j);
      choices[at] = {head[at] - 1, head[at], head[at] + 1};
      std::sort(choices[at].begin(), choices[at].end(),
                [&](int a, int b) { return lattice.distance_term(j, a) < lattice.distance_term(j, b); });
    }
    std::set<std::pair<double, LatticeIndex>> open;  // by distance; each leads on to those one rank worse
    std::set<LatticeIndex> known;
    const auto add = [&](const LatticeIndex& ranks) {
      if (!known.insert(ranks).second) return;
      LatticeIndex node(joints);
      for (std::size_t j = 0; j < joints; ++j) node[j] = choices[j][static_cast<std::size_t>(ranks[j])];
      open.insert({lattice.squared_distance(node), ranks});
    };
    add(LatticeIndex(joints, 0));
    NeighbourQueue queue(lattice);
    queue.add_head(0, head);
    for (int count = 0; count < 2000; ++count) {
      const auto [distance, ranks] = *open.begin();
      open.erase(open.begin());
      for (std::size_t j = 0; j < joints; ++j) {
        if (ranks[j] == 2) continue;
        LatticeIndex worse = ranks;
        ++worse[j];
        add(worse);
      }
      const Neighbour neighbour = queue.pop();
      EXPECT_EQ(neighbour.squared_distance, distance) << count;
      EXPECT_EQ(lattice.squared_distance(neighbour.node), distance);
    }
  }
}

TEST(NeighbourQueue, IsStoppedWithinAGroupOfThousandsAtOneDistance) {
  const Robot robot = long_chain(40);
  const ConfigurationSpace space(robot, VoxelScene{}.snapshot(), {.critical_by_default = false});
  const PathCost cost(robot);
  const Configuration here = Configuration::Zero(40);
  const Lattice lattice({space, cost, here, here}, BeamOptions{});  // 79,040 ways to move three joints
  int asked = 0;
  NeighbourQueue queue(lattice, 0.0, nullptr, [&asked] { return ++asked > 30; });
  queue.add_head(0, LatticeIndex(40, 0));
  std::size_t count = 0;
  for (; !queue.empty(); ++count) queue.pop();
  EXPECT_GE(count, 3201U);  // all that move two joints or fewer
  EXPECT_EQ(asked, 31);
}

TEST(Beam, PlansForARobotOfFortyJoints) {
  const Robot robot = long_chain(40);
  VoxelScene scene;
  scene.occupied.emplace_back(Eigen::Vector3d(0.3, -0.2, 0.03), Eigen::Vector3d(0.6, 0.2, 0.08));
  const ConfigurationSpace space(robot, scene.snapshot(), {.critical_by_default = false});
  const PathCost cost(robot);
  Configuration goal(40);
  for (Eigen::Index j = 0; j < 40; ++j) goal[j] = 0.01 * static_cast<double>(j % 7 - 3);
  const PlanProblem problem{space, cost, Configuration::Zero(40), goal};
  const PlanResult result = make_planner("beam", {{"width", "5"}, {"step", "0.005"}})->plan(problem);
  ASSERT_EQ(result.status, PlanStatus::solved) << result.explanation;
  EXPECT_EQ(result.search_steps, 5);  // 0.03 rad in steps of 0.005, to within one
  for (std::size_t i = 1; i < result.waypoints.size(); ++i)
    EXPECT_TRUE(space.is_edge_free(result.waypoints[i - 1], result.waypoints[i]));
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

}  // namespace neighbour_queue_test
}  // namespace clearway
