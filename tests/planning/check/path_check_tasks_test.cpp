// What the independent check sets out to prove, against the robot's definitions and the space that planners
// ask.
#include <gtest/gtest.h>

#include <filesystem>
#include <set>

#include "planning/check/path_check_model.hpp"
#include "planning/robot/self_collision.hpp"
#include "tests/worlds/batch_worlds.hpp"

namespace clearway::check {
namespace path_check_tasks_test {

/// Those whose files are gone as if they had been made in memory.
std::vector<Robot> robots_of_all_kinds() {
  std::vector<Robot> robots = worlds::robots_of_all_kinds();
  for (Robot& robot : robots)
    if (!std::filesystem::exists(robot.source)) robot.source.clear();
  return robots;
}

/// A map of three volumes: one for the first part, one for the first two, one for whom none names.
Snapshot painted_map(const Robot& robot) {
  FreeSpaceMap map({.resolution = 0.1});
  const std::string first = robot.bodies.front().part, second = robot.bodies[robot.bodies.size() / 2].part;
  map.paint(map.add_volume("one", {first}), {Eigen::Vector3d::Zero(), 0.3});
  map.paint(map.add_volume("two", {first, second}), {Eigen::Vector3d::UnitX(), 0.3});
  map.paint(map.add_volume("all", {}), {Eigen::Vector3d::UnitY(), 0.3});
  return map.snapshot();
}

TEST(PathCheckTasks, EachBodyThatMovesIsProvedOnceUnderItsPolicyAndVolumes) {
  for (const Robot& robot : robots_of_all_kinds()) {
    SCOPED_TRACE(robot.name);
    const Snapshot map = painted_map(robot);
    const KdlArm arm(robot);
    const FclBodies bodies(robot);
    Random random(3);
    for (int round = 0; round < 6; ++round) {
      std::map<std::string, Policy> policies;
      for (const Body& body : robot.bodies) {
        const int choice = random.below(4);
        if (choice == 0) continue;
        policies[body.part] = choice == 1   ? Policy::painted
                              : choice == 2 ? Policy::known_free
                                            : Policy::not_occupied;
      }
      const Tasks tasks = list_tasks(robot, map, policies, arm, bodies);
      std::vector<int> seen(robot.bodies.size(), 0);
      for (const Item& item : tasks.items) {
        if (item.other) continue;
        ++seen[item.body];
        ASSERT_LT(item.group, tasks.groups.size());
        const std::string& part = robot.bodies[item.body].part;
        const Policy policy = policies.contains(part) ? policies[part] : Policy::not_occupied;
        const std::uint16_t named = map.volumes_of_part(part);
        EXPECT_EQ(tasks.groups[item.group].policy, policy);
        EXPECT_EQ(tasks.groups[item.group].volumes, policy == Policy::painted && named != 0 ? named : 0xffff)
            << part;
      }
      for (std::size_t i = 0; i < tasks.groups.size(); ++i)
        for (std::size_t k = 0; k < i; ++k) EXPECT_FALSE(tasks.groups[i] == tasks.groups[k]);
      const ConfigurationSpace space(robot, map, {.critical_by_default = false});
      std::vector<int> moved(robot.bodies.size(), 0);
      for (const int body : space.collision_model().indices) moved[static_cast<std::size_t>(body)] = 1;
      EXPECT_EQ(seen, moved);
    }
  }
}

TEST(PathCheckTasks, EachPairThatMayTouchAndHasNoReasonNotToIsProvedOnce) {
  std::size_t pairs = 0;
  for (const Robot& robot : robots_of_all_kinds()) {
    SCOPED_TRACE(robot.name);
    const KdlArm arm(robot);
    const FclBodies bodies(robot);
    const auto justified = justified_exemptions(robot, arm, bodies);
    std::set<std::pair<std::size_t, std::size_t>> found, expected;
    for (const Item& item : list_tasks(robot, Snapshot(), {}, arm, bodies).items) {
      if (!item.other) continue;
      EXPECT_TRUE(found.emplace(item.body, *item.other).second);
    }
    for (std::size_t a = 0; a < robot.bodies.size(); ++a) {
      for (std::size_t b = a + 1; b < robot.bodies.size(); ++b)
        if (arm.may_touch(a, b) && !justified.contains({a, b})) expected.emplace(a, b);
    }
    EXPECT_EQ(found, expected);
    for (const BodyPair& pair : self_collision_pairs(robot))
      EXPECT_TRUE(
          found.contains({static_cast<std::size_t>(pair.first), static_cast<std::size_t>(pair.second)}));
    pairs += found.size();
  }
  EXPECT_GT(pairs, 20U);
}

/// The box by its definition: about so many places on the edge, each grown by half the way to the next.
TEST(PathCheckTasks, TheBoxOfAnEdgeHoldsAllOfItsGroupAndIsNoLargerThanItsSamplesSay) {
  for (const Robot& robot : robots_of_all_kinds()) {
    SCOPED_TRACE(robot.name);
    const KdlArm arm(robot);
    const FclBodies bodies(robot);
    Tasks tasks;
    tasks.groups.resize(2);
    const std::size_t count = robot.bodies.size();
    for (std::size_t i = 0; i < count; ++i) tasks.items.push_back({i, std::nullopt, i % 2});
    for (std::size_t i = 1; i < count; ++i) tasks.items.push_back({i, i - 1, i % 2});
    Random random(4);
    for (int trial = 0; trial < 20; ++trial) {
      const Configuration start = random.configuration(robot);
      const Eigen::VectorXd step = random.unit() * (random.configuration(robot) - start);
      const std::size_t group = static_cast<std::size_t>(trial) % 2;
      const double spacing = trial % 3 == 0 ? 100.0 : random.between(0.02, 0.5);
      double motion = 0.0;
      for (std::size_t i = group; i < count; i += 2)
        motion = std::max(motion, arm.motion(i, step.cwiseAbs()));
      int pieces = 1;
      while (motion > spacing * pieces) ++pieces;
      Eigen::AlignedBox3d expected;
      for (int k = 0; k <= pieces; ++k) {
        for (std::size_t i = group; i < count; i += 2)
          expected.extend(
              bounds(bodies, i, arm.place(start + step * (double(k) / pieces), i), motion / pieces / 2));
      }
      const Eigen::AlignedBox3d box = swept_box(arm, bodies, tasks, group, start, step, spacing);
      EXPECT_LT((box.min() - expected.min()).norm(), 1e-9);
      EXPECT_LT((box.max() - expected.max()).norm(), 1e-9);
      for (int k = 0; k <= 50; ++k) {
        for (std::size_t i = group; i < count; i += 2)
          EXPECT_TRUE(box.contains(arm.place(start + step * (k / 50.0), i).translation()));
      }
    }
  }
}

}  // namespace path_check_tasks_test
}  // namespace clearway::check
