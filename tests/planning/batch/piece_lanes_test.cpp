// Looks at pieces side by side: against kinematics and shapes at double precision, and with each kind of
// registers against the others.

#include "planning/batch/piece_lanes.hpp"

#include <gtest/gtest.h>

#include "tests/worlds/batch_worlds.hpp"
#include "tests/worlds/instruction_sets.hpp"

namespace clearway {
namespace piece_lanes_test {

constexpr auto lanes = static_cast<std::size_t>(PieceLanes::count);

/// Random configurations, and ways from there, for all lanes.
void draw(Random& random, const Robot& robot, double way, PieceLanes& pieces) {
  for (std::size_t lane = 0; lane < lanes; ++lane) {
    const Configuration q = random.configuration(robot), to = random.configuration(robot);
    for (std::size_t j = 0; j < robot.dof(); ++j) {
      const auto i = static_cast<Eigen::Index>(j);
      pieces.q[j].at[lane] = q[i];
      pieces.step[j].at[lane] = way * (to[i] - q[i]);
    }
  }
  pieces.moving = way > 0.0;
  for (auto* rows : {&pieces.bend, &pieces.pair_bend, &pieces.approach}) {
    for (auto& row : *rows) std::fill(std::begin(row.at), std::end(row.at), way > 0.0 ? 10.0F : 0.0F);
  }
  pieces.want_all(PieceLanes::count);
}

Configuration middle(const PieceLanes& pieces, std::size_t lane) {
  Configuration q(static_cast<Eigen::Index>(pieces.q.size()));
  for (std::size_t j = 0; j < pieces.q.size(); ++j) q[static_cast<Eigen::Index>(j)] = pieces.q[j].at[lane];
  return q;
}

/// Where a sphere is by the pose of its frame.
Eigen::Vector3d place(const SphereRobot& robot, const PieceLanes& pieces, std::size_t sphere,
                      std::size_t lane) {
  const PieceLanes::Floats* pose = &pieces.pose[12 * static_cast<std::size_t>(robot.frame_of[sphere])];
  Eigen::Matrix3d rotation;
  Eigen::Vector3d translation;
  for (int i = 0; i < 9; ++i) rotation(i / 3, i % 3) = pose[i].at[lane];
  for (int i = 0; i < 3; ++i) translation[i] = pose[9 + i].at[lane];
  const SphereRobot::FloatSphere& at = robot.spheres[sphere];
  return rotation * Eigen::Vector3d(at.x, at.y, at.z) + translation;
}

TEST(PieceLanes, SpheresAreWhereKinematicsHaveThemButForATenthOfTheSlack) {
  for (Robot robot : worlds::robots_of_all_kinds()) {
    Random random(3);
    robot.map_from_base = random.pose(1.0);
    const ConfigurationSpace space(robot, worlds::voxels_about(robot, 1), {.critical_by_default = false});
    const CollisionModel& model = space.collision_model();
    ASSERT_NE(model.spheres, nullptr) << robot.name;
    const SphereRobot& spheres = *model.spheres;
    PieceLanes pieces(spheres);
    for (int round = 0; round < 20; ++round) {
      draw(random, model.robot, 0.0, pieces);
      look(spheres, pieces);
      for (std::size_t lane = 0; lane < lanes; ++lane) {
        const LinkPoses poses = forward_kinematics(model.robot, middle(pieces, lane));
        std::vector<Eigen::Vector3d> expected;  // by frame, field and body: compared as sets, sorted
        for (const Body& body : model.robot.bodies) {
          for (const Sphere& sphere : lane_cover(body, space.map().resolution()))
            expected.push_back(poses[static_cast<std::size_t>(body.link)] * sphere.center -
                               robot.map_from_base.translation());
        }
        ASSERT_EQ(expected.size(), spheres.spheres.size());
        for (std::size_t sphere = 0; sphere < spheres.spheres.size(); ++sphere) {
          const Eigen::Vector3d at = place(spheres, pieces, sphere, lane);
          double nearest = 1e9;
          for (const Eigen::Vector3d& one : expected) nearest = std::min(nearest, (one - at).norm());
          ASSERT_LT(nearest, 0.1 * spheres.slack) << robot.name << " sphere " << sphere;
        }
      }
    }
  }
}

/// What was proved free in the middle is free by shapes, and what is blocked is not.
struct Counts {
  int proved = 0, blocked = 0, open = 0;
};
void judge(const CollisionModel& model, PieceLanes& pieces, Counts& counts) {
  look(*model.spheres, pieces);
  for (std::size_t lane = 0; lane < lanes; ++lane) {
    const LinkPoses poses = forward_kinematics(model.robot, middle(pieces, lane));
    const auto is_open = [&](std::size_t member) { return (pieces.failed[member] >> lane & 1U) != 0; };
    bool is_free = true;
    for (std::size_t i = 0; i < model.bodies.size(); ++i) {
      const bool clear = model.bodies[i].is_clear(model.pose(poses, i), model.options.padding);
      EXPECT_TRUE(clear || is_open(i)) << model.robot.name << " " << model.bodies[i].body().part;
      is_free = is_free && clear;
      (is_open(i) ? counts.open : counts.proved)++;
    }
    for (std::size_t i = 0; i < model.pairs.size(); ++i) {
      const bool apart = is_apart(model.robot, model.pairs[i], poses, 0.0);
      EXPECT_TRUE(apart || is_open(model.bodies.size() + i)) << model.robot.name << " pair " << i;
      is_free = is_free && apart;
      (is_open(model.bodies.size() + i) ? counts.open : counts.proved)++;
    }
    if ((pieces.blocked >> lane & 1U) == 0) continue;
    EXPECT_FALSE(is_free) << model.robot.name;
    ++counts.blocked;
  }
}

Counts judge(const ConfigurationSpace& space, std::uint64_t seed, int rounds) {
  const CollisionModel& model = space.collision_model();
  PieceLanes pieces(*model.spheres);
  Random random(seed);
  Counts counts;
  for (int round = 0; round < rounds; ++round) {
    draw(random, model.robot, 0.0, pieces);
    judge(model, pieces, counts);
  }
  return counts;
}

TEST(PieceLanes, WhatIsProvedFreeIsFreeAndWhatIsBlockedIsNotOnTheVeryBorder) {
  Counts all;
  for (const Robot& robot : worlds::robots_of_all_kinds()) {
    const Snapshot map = worlds::voxels_about(robot, 2);
    for (const double padding : {0.0, 0.02}) {
      const Policies policies{.other = padding > 0.0 ? Policy::painted : Policy::not_occupied};
      const ConfigurationSpace space(robot, map, policies, {.padding = padding});
      const CollisionModel& model = space.collision_model();
      const std::vector<Configuration> sides = worlds::on_borders(model, 16, 4 * lanes);
      PieceLanes pieces(*model.spheres);
      Random random(1);
      for (std::size_t first = 0; first + lanes <= sides.size(); first += lanes) {
        draw(random, model.robot, 0.0, pieces);
        for (std::size_t lane = 0; lane < lanes; ++lane) {
          for (std::size_t j = 0; j < model.robot.dof(); ++j)
            pieces.q[j].at[lane] = sides[first + lane][static_cast<Eigen::Index>(j)];
        }
        judge(model, pieces, all);
      }
    }
  }
  EXPECT_GT(all.open, 300);
}

TEST(PieceLanes, WhatIsProvedFreeIsFreeAndWhatIsBlockedIsNot) {
  Counts all;
  for (Robot robot : worlds::robots_of_all_kinds()) {
    Random random(5);
    robot.map_from_base.translation() = random.point(2.0);
    const Snapshot map = worlds::voxels_about(robot, 2);
    for (const Policies& policies :
         {Policies{.critical_by_default = false}, Policies{.other = Policy::known_free},
          Policies{.other = Policy::painted, .critical_by_default = false}}) {
      for (const double padding : {0.0, 0.02}) {
        const ConfigurationSpace space(robot, map, policies, {.padding = padding, .max_distance = 0.1});
        const Counts counts = judge(space, 6, 30);
        all.proved += counts.proved, all.open += counts.open, all.blocked += counts.blocked;
      }
    }
  }
  EXPECT_GT(all.proved, 10'000);
  EXPECT_GT(all.open, 1'000);
  EXPECT_GT(all.blocked, 1'000);
}

TEST(PieceLanes, MostOfWhatIsFreeIsProved) {
  const Robot robot = load_robot("puma560");
  const ConfigurationSpace space(robot, worlds::voxels_about(robot, 2, 0.02), {.critical_by_default = false});
  const Counts counts = judge(space, 7, 100);
  EXPECT_GT(counts.proved, 20 * counts.open);
}

TEST(PieceLanes, AllRegistersFindTheSame) {
  const std::vector<InstructionSet> kinds = worlds::instruction_sets();
  for (const Robot& robot : worlds::robots_of_all_kinds()) {
    const ConfigurationSpace space(robot, worlds::voxels_about(robot, 3), {});
    const SphereRobot& spheres = *space.collision_model().spheres;
    for (const double way : {0.0, 0.01}) {
      std::vector<PieceLanes> found(kinds.size(), PieceLanes(spheres));
      for (std::size_t kind = 0; kind < kinds.size(); ++kind) {
        Random random(8);
        for (int round = 0; round < 20; ++round) {
          draw(random, robot, way, found[kind]);
          for (auto* rows : {&found[kind].bend, &found[kind].pair_bend}) {
            for (auto& row : *rows) std::fill(std::begin(row.at), std::end(row.at), 0.001F);
          }
          look(spheres, found[kind], kinds[kind]);
        }
        EXPECT_EQ(found[kind].failed, found[0].failed) << robot.name;
        EXPECT_EQ(found[kind].blocked, found[0].blocked) << robot.name;
        EXPECT_EQ(found[kind].stuck, found[0].stuck) << robot.name;
        EXPECT_EQ(found[kind].members, found[0].members) << robot.name;
        for (std::size_t i = 0; i < spheres.frames.size() * 12; ++i)
          EXPECT_EQ(0, std::memcmp(found[kind].pose[i].at, found[0].pose[i].at, sizeof(found[0].pose[i].at)));
      }
    }
  }
}

TEST(PieceLanes, LanesAndMembersThatNobodyAsksForStayUnjudged) {
  const Robot robot = load_robot("arm5");
  const ConfigurationSpace space(robot, worlds::voxels_about(robot, 4), {.critical_by_default = false});
  const SphereRobot& spheres = *space.collision_model().spheres;
  PieceLanes all(spheres), some(spheres);
  Random random(9), again(9);
  for (int round = 0; round < 20; ++round) {
    draw(random, robot, 0.0, all);
    draw(again, robot, 0.0, some);
    look(spheres, all);
    some.want_none();
    some.active = 0x0f0f;
    for (int lane = 0; lane < 4; ++lane) some.want(lane, lane), some.want(lane + 4, lane + 8);
    look(spheres, some);
    for (std::size_t member = 0; member < spheres.members; ++member)
      ASSERT_EQ(some.failed[member], all.failed[member] & some.wanted[member] & some.active) << member;
  }
}

}  // namespace piece_lanes_test
}  // namespace clearway
