#include "planning/robot/reach.hpp"

#include <gtest/gtest.h>

#include "planning/robot/kinematics.hpp"
#include "planning/robot_files/load_robot.hpp"
#include "planning/space/configuration_space.hpp"
#include "tests/worlds/random_world.hpp"
#include "tests/worlds/urdf_robots.hpp"

namespace clearway {
namespace reach_test {

/// With limits that Random samples.
Robot shipped_robot(const char* name) {
  Robot robot = load_robot(name);
  for (Joint& joint : robot.joints) {
    joint.lower = std::max(joint.lower, -2 * std::numbers::pi);
    joint.upper = std::min(joint.upper, 2 * std::numbers::pi);
  }
  return robot;
}

TEST(Reach, TheBoxHoldsTheBodyInEveryConfigurationAndIsNotFarTooLarge) {
  for (const char* name : {"puma560", "panda", "arm5", "arm6", "planar2", "point"}) {
    Robot robot = shipped_robot(name);
    Random random(1);
    for (int placement = 0; placement < 2; ++placement) {
      for (const Body& body : robot.bodies) {
        const Eigen::AlignedBox3d box = reach_box(robot, body);
        Eigen::AlignedBox3d seen;
        for (int i = 0; i < 3'000; ++i) {
          const LinkPoses poses = forward_kinematics(robot, random.configuration(robot));
          seen.extend(body.shape.bounds(poses[static_cast<std::size_t>(body.link)] * body.link_from_shape));
        }
        const Eigen::AlignedBox3d grown(box.min().array() - 1e-9, box.max().array() + 1e-9);
        EXPECT_TRUE(grown.contains(seen)) << name << " " << body.part;
        EXPECT_LT(box.sizes().maxCoeff(), 2.1 * seen.sizes().maxCoeff()) << name << " " << body.part;
      }
      robot.map_from_base = random.pose(1.0);
    }
  }
}

TEST(Reach, SlidingAndPlanarRobotsStayInTheirPlane) {
  const Robot disc = load_robot("point"), arm = load_robot("planar2");
  EXPECT_NEAR(reach_box(disc, disc.bodies.back()).sizes().z(), 0.01, 1e-12);
  EXPECT_LT(reach_box(arm, arm.bodies.back()).sizes().z(), 0.12);  // capsules of radius 0.05
}

TEST(Reach, ASlideWithoutLimitsReachesEverythingInAMap) {
  Robot robot = load_robot("point");
  FreeSpaceMap map({.resolution = 0.05});
  occupy(map, {2.025, 0.025, 0.025});
  const Policies anywhere{.critical_by_default = false};
  for (Joint& joint : robot.joints) {
    joint.lower = -std::numeric_limits<double>::infinity();
    joint.upper = std::numeric_limits<double>::infinity();
  }
  const Eigen::AlignedBox3d box = reach_box(robot, robot.bodies[0]);
  EXPECT_TRUE(box.contains(Eigen::Vector3d(1e6, -1e6, 0.0)) && box.contains(Eigen::Vector3d(-1e6, 1e6, 0.0)));
  const ConfigurationSpace space(robot, map.snapshot(), anywhere);
  EXPECT_TRUE(space.is_free(Eigen::Vector2d(0.0, 0.0)));
  EXPECT_FALSE(space.is_free(Eigen::Vector2d(2.0, 0.0)));
  EXPECT_FALSE(space.is_edge_free(Eigen::Vector2d(1.0, 0.0), Eigen::Vector2d(3.0, 0.0)));
}

TEST(Reach, TheTipIsNeverFartherThanItsReachAndNearlySoFarWhereTheArmIsStraight) {
  for (const char* name : {"puma560", "panda", "arm5", "arm6", "planar2", "point"}) {
    Robot robot = shipped_robot(name);
    Random random(2);
    robot.map_from_base = random.pose(1.0);
    double farthest = 0.0;
    for (int i = 0; i < 3'000; ++i) {
      const Eigen::Isometry3d tip = tip_pose(robot, random.configuration(robot));
      farthest = std::max(farthest, (tip.translation() - robot.map_from_base.translation()).norm());
    }
    EXPECT_LE(farthest, tip_reach(robot)) << name;
    EXPECT_LT(tip_reach(robot), 2.1 * farthest) << name;
  }
  const Robot arm = load_robot("planar2");
  EXPECT_NEAR(tip_pose(arm, Eigen::Vector2d(0.3, 0.0)).translation().norm(), tip_reach(arm), 1e-8);
}

/// The bound turns away nothing that the straight arm can just touch.
TEST(Reach, AStraightArmsOwnTipIsFoundAgain) {
  const Robot arm = load_robot("planar2");
  const Eigen::Vector2d straight(0.3, 0.0);
  EXPECT_TRUE(inverse_kinematics(arm, tip_pose(arm, straight), straight));
  Eigen::Isometry3d beyond = tip_pose(arm, straight);
  beyond.translation() *= 1.001;
  EXPECT_FALSE(inverse_kinematics(arm, beyond, straight));
}

TEST(Reach, ALeverIsAsLongAsTheFarthestPointSeenFromTheJointAxis) {
  const Robot arm = load_robot("planar2");
  EXPECT_NEAR(lever(arm, 1, arm.bodies[0]), 1.05, 1e-2);  // about the shoulder
  EXPECT_NEAR(lever(arm, 1, arm.bodies[1]), 2.05, 1e-2);
  EXPECT_NEAR(lever(arm, 2, arm.bodies[1]), 1.05, 1e-2);  // about the elbow
}

TEST(Reach, ALeverOfABodyOnItsOwnLinkIsTheSmallerOfTwoBounds) {
  for (const char* size : {"0.4 0.4 0.4", "2 0.02 0.02", "0.02 0.02 2", "0.5 0.5 0.01"}) {
    const worlds::UrdfRobot robot(
        "probe", "<link name='base'/>" +
                     worlds::urdf_link("slab", "0 0 0", std::string("<box size='") + size + "'/>") +
                     worlds::urdf_joint("turn", "revolute", "base", "slab", "0 0 0", "0 0 1",
                                        worlds::urdf_limit(-3, 3)));
    const Body& body = robot.robot().bodies[0];
    double by_cover = 0.0;
    for (const Sphere& sphere : body.cover)
      by_cover = std::max(by_cover, sphere.center.head<2>().norm() + sphere.radius);
    EXPECT_LE(lever(robot.robot(), 1, body), std::min(by_cover, body.shape.bounding_radius()) * (1 + 1e-12))
        << size;
  }
}

TEST(Reach, ALeverHoldsForSlidesThatGoFarthestAtTheirLowerLimitAndForJointsThatFollowThem) {
  Random random(8);
  for (const Robot& robot : {worlds::telescope().robot(), worlds::rack_and_pinion().robot()})
    for (const Body& body : robot.bodies) {
      for (int mover = body.link; mover >= 0; mover = robot.links[static_cast<std::size_t>(mover)].parent) {
        const Link& link = robot.links[static_cast<std::size_t>(mover)];
        if (link.joint < 0 || kind_of(robot, link) != JointKind::revolute) continue;
        double farthest = 0.0;  // of the body's points from the joint's axis, which is z of its link
        for (int i = 0; i < 2'000; ++i) {
          const LinkPoses poses = forward_kinematics(robot, random.configuration(robot));
          const Eigen::Vector3d point = poses[static_cast<std::size_t>(mover)].inverse() *
                                        poses[static_cast<std::size_t>(body.link)] * body.link_from_shape *
                                        body.shape.support(random.point(1.0));
          farthest = std::max(farthest, point.head<2>().norm());
        }
        EXPECT_GE(lever(robot, mover, body), farthest) << body.part;
        EXPECT_LT(lever(robot, mover, body), 2.0 * farthest + 0.1) << body.part;
      }
    }
}

}  // namespace reach_test
}  // namespace clearway
