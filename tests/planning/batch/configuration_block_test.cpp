// Looks at blocks of configurations: against shapes at double precision, with each kind of registers, and
// alone against in company.

#include "planning/batch/configuration_block.hpp"

#include <gtest/gtest.h>

#include "tests/worlds/batch_worlds.hpp"
#include "tests/worlds/instruction_sets.hpp"

namespace clearway {
namespace configuration_block_test {

std::vector<Configuration> draw(const Robot& robot, std::uint64_t seed, std::size_t count) {
  Random random(seed);
  std::vector<Configuration> qs;
  while (qs.size() < count) qs.push_back(random.configuration(robot));
  return qs;
}

void look_at(const SphereRobot& robot, std::span<const Configuration> qs, ConfigurationBlock& block) {
  block.clear();
  for (const Configuration& q : qs) block.add(q);
  look(robot, block);
}

struct Counts {
  int clear = 0, blocked = 0, open = 0, clear_bodies = 0, open_bodies = 0;
};

/// What is clear is free by shapes, member by member, and what is blocked is not.
Counts judge(const CollisionModel& model, const std::vector<Configuration>& qs) {
  ConfigurationBlock block(*model.spheres);
  look_at(*model.spheres, qs, block);
  Counts counts;
  for (std::size_t i = 0; i < qs.size(); ++i) {
    const bool is_blocked = ConfigurationBlock::holds(block.blocked, i);
    const LinkPoses poses = forward_kinematics(model.robot, qs[i]);
    bool is_free = true, is_open = false;
    for (std::size_t member = 0; member < model.members(); ++member) {
      const std::size_t bodies = model.bodies.size();
      const bool clear = member < bodies
                             ? model.bodies[member].is_clear(model.pose(poses, member), model.options.padding)
                             : is_apart(model.robot, model.pairs[member - bodies], poses, 0.0);
      const bool failed = ConfigurationBlock::holds(block.failed[member], i);
      EXPECT_TRUE(clear || failed || is_blocked) << model.robot.name << " member " << member;
      EXPECT_FALSE(failed && is_blocked) << model.robot.name << " member " << member;
      is_free = is_free && clear;
      is_open = is_open || failed;
      (failed ? counts.open_bodies : counts.clear_bodies)++;
    }
    EXPECT_FALSE(is_free && is_blocked) << model.robot.name << ": " << qs[i].transpose();
    (is_blocked ? counts.blocked : is_open ? counts.open : counts.clear)++;
  }
  EXPECT_EQ(block.undecided(), static_cast<std::size_t>(counts.open)) << model.robot.name;
  return counts;
}

Counts judge(const ConfigurationSpace& space, std::uint64_t seed, std::size_t count) {
  return judge(space.collision_model(), draw(space.collision_model().robot, seed, count));
}

TEST(ConfigurationBlock, WhatIsClearIsFreeAndWhatIsBlockedIsNotOnTheVeryBorder) {
  Counts all;
  for (const Robot& robot : worlds::robots_of_all_kinds()) {
    const Snapshot map = worlds::voxels_about(robot, 2);
    for (const double padding : {0.0, 0.02}) {
      const Policies policies{.other = padding > 0.0 ? Policy::painted : Policy::not_occupied};
      const ConfigurationSpace space(robot, map, policies, {.padding = padding});
      const CollisionModel& model = space.collision_model();
      const Counts counts = judge(model, worlds::on_borders(model, 16, 60));
      all.clear += counts.clear, all.blocked += counts.blocked, all.open += counts.open;
    }
  }
  EXPECT_GT(all.open, 300);
}

TEST(ConfigurationBlock, WhatIsClearIsFreeAndWhatIsBlockedIsNot) {
  Counts all;
  for (Robot robot : worlds::robots_of_all_kinds()) {
    Random random(5);
    robot.map_from_base = random.pose(2.0);
    const Snapshot map = worlds::voxels_about(robot, 2);
    for (const Policies& policies :
         {Policies{.critical_by_default = false}, Policies{.other = Policy::known_free},
          Policies{.other = Policy::painted, .critical_by_default = false}}) {
      for (const double padding : {0.0, 0.02}) {
        const ConfigurationSpace space(robot, map, policies, {.padding = padding, .max_distance = 0.1});
        const Counts counts = judge(space, 6, ConfigurationBlock::most);
        all.clear += counts.clear, all.blocked += counts.blocked, all.open += counts.open;
      }
    }
  }
  EXPECT_GT(all.clear, 1'000);
  EXPECT_GT(all.blocked, 1'000);
  EXPECT_GT(all.open, 100);
}

TEST(ConfigurationBlock, MostIsDecided) {
  const auto counts_of = [](const Robot& robot) {
    const ConfigurationSpace space(robot, worlds::voxels_about(robot, 2, 0.02),
                                   {.critical_by_default = false});
    return judge(space, 7, ConfigurationBlock::most);
  };
  for (const char* name : {"puma560", "arm6"}) {
    const Counts counts = counts_of(load_robot(name));
    EXPECT_LT(8 * counts.open, counts.clear + counts.blocked) << name;
    EXPECT_GT(counts.clear_bodies, 50 * counts.open_bodies) << name;
  }
  const Counts counts = counts_of(worlds::of_hulls(load_robot("puma560")));
  EXPECT_LT(8 * counts.open, counts.clear + counts.blocked);
  EXPECT_GT(counts.blocked, 0);
}

TEST(ConfigurationBlock, AllRegistersFindTheSame) {
  const std::vector<InstructionSet> kinds = worlds::instruction_sets();
  for (const Robot& robot : worlds::robots_of_all_kinds()) {
    const ConfigurationSpace space(robot, worlds::voxels_about(robot, 3), {});
    const SphereRobot& spheres = *space.collision_model().spheres;
    std::vector<Configuration> qs = draw(robot, 8, ConfigurationBlock::most - 3);
    for (std::size_t j = 0; j < robot.joints.size(); ++j) {  // the last cells of the tables of pairs, too
      const auto joint = static_cast<Eigen::Index>(j);
      if (!std::isfinite(robot.joints[j].upper)) continue;
      for (std::size_t i = j; i < qs.size(); i += 40) qs[i][joint] = robot.joints[j].upper;
      for (std::size_t i = j + 20; i < qs.size(); i += 40) qs[i][joint] = robot.joints[j].lower;
    }
    std::vector<ConfigurationBlock> found;
    for (std::size_t kind = 0; kind < kinds.size(); ++kind) {
      found.emplace_back(spheres);
      for (const Configuration& q : qs) found[kind].add(q);
      look(spheres, found[kind], kinds[kind]);
      std::sort(found[kind].members.begin(), found[kind].members.end());
      EXPECT_EQ(found[kind].failed, found[0].failed) << robot.name;
      EXPECT_EQ(found[kind].blocked, found[0].blocked) << robot.name;
      EXPECT_EQ(found[kind].members, found[0].members) << robot.name;
    }
  }
}

TEST(ConfigurationBlock, WhatIsBesideAConfigurationChangesNothing) {
  for (const Robot& robot : worlds::robots_of_all_kinds()) {
    const ConfigurationSpace space(robot, worlds::voxels_about(robot, 4), {.critical_by_default = false});
    const SphereRobot& spheres = *space.collision_model().spheres;
    const std::vector<Configuration> qs = draw(robot, 9, ConfigurationBlock::most);
    ConfigurationBlock together(spheres), few(spheres);
    look_at(spheres, qs, together);
    for (const std::size_t count : {std::size_t{1}, std::size_t{5}, std::size_t{37}}) {
      for (std::size_t first = 0; first + count <= qs.size(); first += count + 11) {
        look_at(spheres, std::span(qs).subspan(first, count), few);
        for (std::size_t i = 0; i < count; ++i) {
          ASSERT_EQ(ConfigurationBlock::holds(few.blocked, i),
                    ConfigurationBlock::holds(together.blocked, first + i));
          for (std::size_t member = 0; member < spheres.members; ++member)
            ASSERT_EQ(ConfigurationBlock::holds(few.failed[member], i),
                      ConfigurationBlock::holds(together.failed[member], first + i))
                << robot.name << " member " << member;
        }
      }
    }
  }
}

TEST(ConfigurationBlock, AnEmptyOneFindsNothing) {
  const Robot robot = load_robot("arm5");
  const ConfigurationSpace space(robot, worlds::voxels_about(robot, 4), {.critical_by_default = false});
  ConfigurationBlock block(*space.collision_model().spheres);
  look(*space.collision_model().spheres, block);
  EXPECT_TRUE(block.members.empty());
  EXPECT_EQ(block.blocked, ConfigurationBlock::Places{});
}

}  // namespace configuration_block_test
}  // namespace clearway
