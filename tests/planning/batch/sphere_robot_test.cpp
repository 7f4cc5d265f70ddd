#include "planning/batch/sphere_robot.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "tests/worlds/batch_worlds.hpp"
#include "tests/worlds/urdf_robots.hpp"

namespace clearway {
namespace sphere_robot_test {

TEST(LaneCover, HoldsTheBodyAndHasNoMoreSpheresThanItsOwn) {
  Random random(1);
  int thinned = 0;
  for (int round = 0; round < 200; ++round) {
    Body body;
    body.link_from_shape = random.pose(1.0);
    body.shape = Shape::box(Eigen::Vector3d(random.between(0.005, 0.06), random.between(0.005, 0.06),
                                            random.between(0.005, 0.06)));
    body.cover = body.shape.sphere_cover();
    for (Sphere& sphere : body.cover) sphere.center = body.link_from_shape * sphere.center;
    const std::vector<Sphere> cover = lane_cover(body, 0.02);
    EXPECT_LE(cover.size(), body.cover.size());
    thinned += cover.size() < body.cover.size();
    for (int i = 0; i < 300; ++i) {
      Eigen::Vector3d point = random.point(0.5).cwiseProduct(body.shape.edges());
      if (i % 3 == 0) point = point.cwiseSign().cwiseProduct(body.shape.edges()) / 2;  // a corner
      point = body.link_from_shape * point;
      EXPECT_TRUE(std::any_of(cover.begin(), cover.end(), [&](const Sphere& sphere) {
        return (sphere.center - point).norm() <= sphere.radius;
      }));
    }
  }
  EXPECT_GT(thinned, 50);
}

TEST(SphereRobot, ABodyThatNothingCoversIsRefused) {
  Robot robot = load_robot("planar2");
  robot.bodies.back().cover.clear();
  EXPECT_THROW(ConfigurationSpace(robot, worlds::voxels_about(load_robot("planar2"), 1),
                                  {.critical_by_default = false}),
               std::invalid_argument);
}

TEST(SphereRobot, KnowsHowSteeplyItsJointsAreFollowed) {
  for (const Robot& robot : {worlds::whip().robot(), worlds::rack_and_pinion().robot()}) {  // of followers
    const ConfigurationSpace space(robot, worlds::voxels_about(robot, 1), {.critical_by_default = false});
    ASSERT_NE(space.collision_model().spheres, nullptr);
    double steepest = 0.0, offset = 0.0;
    for (const Link& link : robot.links) {
      if (link.joint < 0) continue;
      steepest = std::max(steepest, std::abs(link.multiplier));
      offset = std::max(offset, std::abs(link.offset));
    }
    EXPECT_GT(steepest, 0.0);
    EXPECT_EQ(space.collision_model().spheres->steepest, steepest);
    EXPECT_EQ(space.collision_model().spheres->farthest_offset, offset);
  }
}

TEST(SphereRobot, ASecondSpaceOfARobotSharesWhatTheRobotAloneDecides) {
  const Robot robot = worlds::of_hulls(load_robot("puma560"));
  const ConfigurationSpace one(robot, worlds::voxels_about(robot, 1), {.critical_by_default = false});
  const ConfigurationSpace two(robot, worlds::voxels_about(robot, 2), {.critical_by_default = false},
                               {.padding = 0.01});
  Robot other = robot;
  other.joints[2].upper -= 0.1;
  const ConfigurationSpace three(other, worlds::voxels_about(robot, 2), {.critical_by_default = false});
  const SphereRobot &a = *one.collision_model().spheres, &b = *two.collision_model().spheres,
                    &c = *three.collision_model().spheres;
  EXPECT_EQ(a.robot, b.robot);
  EXPECT_NE(a.robot, c.robot);
  EXPECT_NE(a.id, b.id);
  EXPECT_NE(a.fields[0].bytes, b.fields[0].bytes);
  EXPECT_EQ(a.padding, 0.0F);
  EXPECT_GE(b.padding, 0.01F);
  EXPECT_EQ(a.inner, b.inner);
  int shared = 0;
  for (std::size_t i = 0; i < a.branch_pairs.size(); ++i) {
    EXPECT_EQ(a.branch_pairs[i].table, b.branch_pairs[i].table);
    shared += a.branch_pairs[i].table != nullptr;
  }
  EXPECT_GT(shared, 2);
}

TEST(SphereRobot, PaddingIsNeverRoundedDown) {
  const Robot robot = load_robot("puma560");
  const Snapshot map = FreeSpaceMap({.resolution = 0.05}).snapshot();
  Random random(3);
  for (int i = 0; i < 20; ++i) {
    const double padding = random.between(0.0, 0.05);
    const ConfigurationSpace space(robot, map, {}, {.padding = padding});
    EXPECT_GE(static_cast<double>(space.collision_model().spheres->padding), padding);
  }
}

TEST(SphereRobot, AThreadKeepsWhatItMadeForTheLastRobots) {
  const Robot robot = load_robot("planar2");
  const Snapshot map = worlds::voxels_about(robot, 1);
  struct Kept {
    explicit Kept(const SphereRobot& of) : id(of.id) {}
    std::uint64_t id;
  };
  std::vector<std::unique_ptr<ConfigurationSpace>> spaces;
  for (int i = 0; i < 9; ++i)
    spaces.push_back(
        std::make_unique<ConfigurationSpace>(robot, map, Policies{.critical_by_default = false}));
  const auto sphere_robot = [&](std::size_t i) -> const SphereRobot& {
    return *spaces[i]->collision_model().spheres;
  };
  const Kept* first = &of_this_thread<Kept>(sphere_robot(0));
  for (const std::size_t i : {1, 2, 3, 0})
    EXPECT_EQ(of_this_thread<Kept>(sphere_robot(i)).id, sphere_robot(i).id);
  EXPECT_EQ(&of_this_thread<Kept>(sphere_robot(0)), first);
  for (std::size_t i = 0; i < 9; ++i) EXPECT_EQ(of_this_thread<Kept>(sphere_robot(i)).id, sphere_robot(i).id);
  for (std::size_t i = 9; i-- > 0;) EXPECT_EQ(of_this_thread<Kept>(sphere_robot(i)).id, sphere_robot(i).id);
}

/// Drawings state axes such as "3.67e-06 0 -1".
TEST(SphereRobot, BallsOnAxesThatPointAlmostDownMeetWhereTheyAre) {
  Random random(23);
  const auto ball_at = [](int link, const Eigen::Vector3d& place) {
    Body body;
    body.part = "sphere";
    body.link = link;
    body.link_from_shape.translation() = place;
    body.shape = Shape::sphere(0.1);
    body.cover = {{place, 0.1}};
    return body;
  };
  Robot robot = load_robot("planar2");
  robot.links.resize(2);
  robot.links[1].parent = 0;
  robot.links[1].joint = 0;
  robot.links[1].parent_from_link.setIdentity();
  robot.joints.resize(1);
  robot.exempt.clear();
  robot.tip_link = 0;
  for (int i = 0; i < 2000; ++i) {
    const double around = random.between(-3, 3), tilt = std::pow(10.0, random.between(-6.5, -4.5));
    robot.joints[0].axis = Eigen::Vector3d(tilt * std::cos(around), tilt * std::sin(around), -1).normalized();
    const Configuration q = Configuration::Constant(1, random.between(-1, 1));
    robot.bodies = {ball_at(1, Eigen::Vector3d::UnitX())};
    const Eigen::Isometry3d from_base = forward_kinematics(robot, Configuration::Zero(1))[0].inverse();
    const Eigen::Vector3d at = from_base * forward_kinematics(robot, q)[1] * Eigen::Vector3d::UnitX();
    const double gap = random.between(-2e-4, 2e-4);
    robot.bodies.push_back(ball_at(0, at + (0.2 + gap) * at.normalized() * (i % 2 == 0 ? 1 : -1)));
    const ConfigurationSpace space(robot, Snapshot(), {.critical_by_default = false});
    ASSERT_NE(space.collision_model().spheres, nullptr);
    EXPECT_EQ(space.is_free(q), gap > 0.0) << "tilt " << tilt << ", gap " << gap;
  }
}

/// A boom that turns, a slide on it that reaches back farther than forth, and one that mimics that; and
/// one that mimics the boom.
TEST(SphereRobot, LeversHoldWhatSlidesAsFarOutAsItGets) {
  for (const Robot& robot : {worlds::telescope().robot(), worlds::rack_and_pinion().robot()}) {
    const ConfigurationSpace space(robot, worlds::voxels_about(robot, 1), {.critical_by_default = false});
    const SphereRobot& spheres = *space.collision_model().spheres;
    ASSERT_EQ(spheres.frames.size(), robot.links.size());  // each link but the root is moved
    constexpr std::size_t boom = 1;
    Random random(4);
    std::vector<double> farthest(robot.links.size(), 0.0);
    for (int i = 0; i < 2000; ++i) {
      const LinkPoses poses = forward_kinematics(robot, random.configuration(robot));
      for (const Body& body : robot.bodies) {
        const auto link = static_cast<std::size_t>(body.link);
        for (const Sphere& sphere : body.cover) {  // in the boom's frame, which turns about its z
          const Eigen::Vector3d at = poses[boom].inverse() * (poses[link] * sphere.center);
          farthest[link] = std::max(farthest[link], at.head<2>().norm());
        }
      }
    }
    for (std::size_t link = boom; link < robot.links.size(); ++link) {
      const double lever = spheres.lever_of(link, boom);
      EXPECT_LE(farthest[link], lever) << robot.links[link].name;
      if (farthest[link] == 0.0) continue;  // without a body
      EXPECT_LE(lever, 1.6 * farthest[link] + 0.1) << robot.links[link].name;
    }
  }
}

/// A robot made in memory may have its root link anywhere on its base, turned, and other links of no joint
/// below it: where the bodies are decides, however that is said.
TEST(SphereRobot, ItMakesNoDifferenceHowBaseAndRootShareThePlace) {
  int free = 0, blocked = 0;
  for (const char* name : {"arm5", "puma560", "panda"}) {
    Robot plain = load_robot(name);
    plain.source.clear();
    const Snapshot map = worlds::voxels_about(plain, 2);
    Random random(12);
    const ConfigurationSpace one(plain, map, {.critical_by_default = false});
    for (int round = 0; round < 3; ++round) {
      Robot shifted = plain;
      const Eigen::Isometry3d part = random.pose(0.7);
      shifted.links[0].parent_from_link = part * plain.links[0].parent_from_link;
      shifted.map_from_base = plain.map_from_base * part.inverse();
      const ConfigurationSpace other(shifted, map, {.critical_by_default = false});
      ASSERT_NE(other.collision_model().spheres, nullptr);
      for (int i = 0; i < 60; ++i) {
        const Configuration q = random.configuration(plain),
                            end = q + 0.05 * (random.configuration(plain) - q);
        const std::vector<bool> together = other.is_free(std::vector<Configuration>{q, end});
        EXPECT_EQ(one.is_free(q), other.is_free(q)) << name << ' ' << i;
        EXPECT_EQ(one.is_free(q), together[0]) << name << ' ' << i;
        EXPECT_EQ(one.is_edge_free(q, end), other.is_edge_free(q, end)) << name << ' ' << i;
        (one.is_free(q) ? free : blocked)++;
      }
    }
  }
  EXPECT_GT(free, 50);
  EXPECT_GT(blocked, 50);
}

/// What rounding may do grows with the farthest point of any ball, not with the farthest middle.
TEST(SphereRobot, SlackIsThatOfTheFarthestPointOfABall) {
  const auto slack = [](const std::string& radius) {
    const worlds::UrdfRobot made(
        "ball_on_arm", worlds::urdf_link("base", "0 0 -5", "<sphere radius='0.05'/>") +
                           worlds::urdf_link("arm", "0.5 0 0", "<sphere radius='" + radius + "'/>") +
                           worlds::urdf_joint("turn", "revolute", "base", "arm", "0 0 0", "0 0 1",
                                              worlds::urdf_limit(-2, 2)));
    const ConfigurationSpace space(made.robot(), worlds::voxels_about(made.robot(), 1),
                                   {.critical_by_default = false});
    return space.collision_model().spheres->slack;
  };
  EXPECT_GT(slack("8"), 1.2F * slack("3"));
}

TEST(LaneCover, SpheresOfASmallBoxStandOutByAQuarterOfAVoxelAtMost) {
  constexpr double voxel = 0.02;
  Random random(2);
  int thinned = 0;
  for (int round = 0; round < 200; ++round) {
    Body body;
    body.link_from_shape = random.pose(1.0);
    const Eigen::Vector3d edges(random.between(0.005, 0.06), random.between(0.005, 0.06),
                                random.between(0.005, 0.06));
    body.shape = Shape::box(edges);
    body.cover = body.shape.sphere_cover();
    const std::vector<Sphere> cover = lane_cover(body, voxel);
    if (cover.size() == body.cover.size()) continue;
    ++thinned;
    for (const Sphere& sphere : cover) {
      const Eigen::Vector3d center = body.link_from_shape.inverse() * sphere.center;
      EXPECT_LE((center.cwiseAbs() - edges / 2).maxCoeff() + sphere.radius, 0.25 * voxel + 1e-9);
    }
  }
  EXPECT_GT(thinned, 50);
}

}  // namespace sphere_robot_test
}  // namespace clearway
