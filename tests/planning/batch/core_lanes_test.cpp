// Quick refusals against shapes at double precision, the full look, and each kind of registers.

#include "planning/batch/core_lanes.hpp"

#include <gtest/gtest.h>

#include "tests/worlds/batch_worlds.hpp"
#include "tests/worlds/instruction_sets.hpp"

namespace clearway {
namespace core_lanes_test {

constexpr auto lanes = static_cast<std::size_t>(PieceLanes::count);
constexpr PieceLanes::Lanes all = 0xffff, none = 0;

/// Random configurations in all lanes.
std::vector<Configuration> draw(Random& random, const Robot& robot, PieceLanes& pieces) {
  std::vector<Configuration> qs;
  for (std::size_t lane = 0; lane < lanes; ++lane) {
    qs.push_back(random.configuration(robot));
    for (std::size_t j = 0; j < robot.dof(); ++j)
      pieces.q[j].at[lane] = qs.back()[static_cast<Eigen::Index>(j)];
  }
  pieces.moving = false;
  pieces.want_all(PieceLanes::count);
  return qs;
}

TEST(CoreLanes, WhatTheyRefuseIsNotFreeAndTheyRefuseMuchOfIt) {
  int refused = 0, missed = 0;
  for (Robot robot : worlds::robots_of_all_kinds()) {
    Random random(5);
    robot.map_from_base.translation() = random.point(2.0);
    const Snapshot map = worlds::voxels_about(robot, 2);
    for (const Policies& policies : {Policies{.critical_by_default = false},
                                     Policies{.other = Policy::known_free, .critical_by_default = false}}) {
      const ConfigurationSpace space(robot, map, policies, {.padding = 0.01});
      const CollisionModel& model = space.collision_model();
      PieceLanes pieces(*model.spheres);
      for (int round = 0; round < 30; ++round) {
        const std::vector<Configuration> qs = draw(random, model.robot, pieces);
        const PieceLanes::Lanes touching = touching_lanes(*model.spheres, pieces, none);
        for (std::size_t lane = 0; lane < lanes; ++lane) {
          const LinkPoses poses = forward_kinematics(model.robot, qs[lane]);
          bool is_clear = true;
          for (std::size_t i = 0; i < model.bodies.size(); ++i)
            is_clear = is_clear && model.bodies[i].is_clear(model.pose(poses, i), model.options.padding);
          const bool is_refused = (touching >> lane & 1U) != 0;
          EXPECT_FALSE(is_refused && is_clear) << robot.name;
          refused += is_refused;
          missed += !is_refused && !is_clear;
        }
      }
    }
  }
  EXPECT_GT(refused, 1'000);
  EXPECT_GT(2 * refused, missed);
}

TEST(CoreLanes, WhatIsFreeByAHairIsNotRefused) {
  std::size_t sides = 0;
  for (const Robot& robot : worlds::robots_of_all_kinds()) {
    const Snapshot map = worlds::voxels_about(robot, 2);
    for (const double padding : {0.0, 0.02}) {
      const ConfigurationSpace space(robot, map, {.critical_by_default = false}, {.padding = padding});
      const CollisionModel& model = space.collision_model();
      PieceLanes pieces(*model.spheres);
      Random random(1);
      for (const Configuration& q : worlds::on_borders(model, 17, 40)) {
        if (!model.is_free_by_shapes(q)) continue;
        ++sides;
        draw(random, model.robot, pieces);
        for (std::size_t j = 0; j < model.robot.dof(); ++j)
          pieces.q[j].at[sides % lanes] = q[static_cast<Eigen::Index>(j)];
        EXPECT_EQ(touching_lanes(*model.spheres, pieces, none) >> (sides % lanes) & 1U, 0U) << robot.name;
      }
    }
  }
  EXPECT_GT(sides, 100U);
}

TEST(CoreLanes, AllRegistersFindTheSameAndPlaceTheFramesAsTheLookDoes) {
  const std::vector<InstructionSet> kinds = worlds::instruction_sets();
  for (const Robot& robot : worlds::robots_of_all_kinds()) {
    const ConfigurationSpace space(robot, worlds::voxels_about(robot, 3), {});
    const SphereRobot& spheres = *space.collision_model().spheres;
    PieceLanes pieces(spheres), looked(spheres);
    for (int round = 0; round < 20; ++round) {
      Random random(static_cast<unsigned>(round)), again(static_cast<unsigned>(round));
      draw(random, robot, pieces);
      draw(again, robot, looked);
      look(spheres, looked);
      const PieceLanes::Lanes found = touching_lanes(spheres, pieces, none, kinds.front());
      for (const InstructionSet kind : kinds) {
        EXPECT_EQ(touching_lanes(spheres, pieces, none, kind), found) << robot.name;
        const PieceLanes::Lanes some = touching_lanes(spheres, pieces, all, kind);
        EXPECT_EQ(some != 0, found != 0) << robot.name;
        EXPECT_EQ(some & ~found, 0) << robot.name;
        for (std::size_t i = 0; i < pieces.pose.size(); ++i)
          ASSERT_EQ(0, std::memcmp(pieces.pose[i].at, looked.pose[i].at, sizeof(looked.pose[i].at)));
      }
    }
  }
}

TEST(CoreLanes, LanesThatAreNotActiveAreNotReported) {
  const Robot robot = load_robot("puma560");
  const ConfigurationSpace space(robot, worlds::voxels_about(robot, 2), {.critical_by_default = false});
  const SphereRobot& spheres = *space.collision_model().spheres;
  PieceLanes pieces(spheres);
  Random random(4);
  int touching = 0;
  for (int round = 0; round < 50; ++round) {
    draw(random, robot, pieces);
    const PieceLanes::Lanes found = touching_lanes(spheres, pieces, none);
    pieces.active = 0x0f3c;
    EXPECT_EQ(touching_lanes(spheres, pieces, none), found & 0x0f3c);
    touching += found != 0;
  }
  EXPECT_GT(touching, 10);
}

}  // namespace core_lanes_test
}  // namespace clearway
