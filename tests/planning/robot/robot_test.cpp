#include "planning/robot/robot.hpp"

#include <gtest/gtest.h>

#include "planning/robot/kinematics.hpp"
#include "planning/robot_files/load_robot.hpp"
#include "planning/space/configuration_space.hpp"
#include "tests/worlds/fcl_truth.hpp"
#include "tests/worlds/random_world.hpp"

namespace clearway {
namespace robot_test {

TEST(Robot, EveryRobotThatComesWithTheProgramLoadsAndCanBeFree) {
  const auto robots = available_robots();
  ASSERT_GE(robots.size(), 5u);
  for (const auto& [name, description] : robots) {
    EXPECT_FALSE(description.empty()) << name;
    const Robot robot = load_robot(name);
    for (const Body& body : robot.bodies) EXPECT_FALSE(body.cover.empty()) << name;
    for (const Joint& joint : robot.joints) {
      EXPECT_GT(joint.friction, 0.0) << name;
      EXPECT_GT(joint.step, 0.0) << name;
    }
    EXPECT_FALSE(robot.critical_parts.empty()) << name;
  }
}

/// Lengths and what is made of them grow by the factor, angles and their rates stay.
TEST(Robot, OfAScaledRobotSlidesGrowAndTurnsStay) {
  for (const char* name : {"point", "planar2"}) {
    const Robot robot = load_robot(name);
    for (const double factor : {0.5, 3.0}) {
      const Robot larger = scaled(robot, factor);
      for (std::size_t j = 0; j < robot.dof(); ++j) {
        const Joint &was = robot.joints[j], &is = larger.joints[j];
        const double by = was.kind == JointKind::prismatic ? factor : 1.0;
        for (double Joint::*value : {&Joint::lower, &Joint::upper, &Joint::max_velocity,
                                     &Joint::max_acceleration, &Joint::max_jerk, &Joint::step})
          EXPECT_DOUBLE_EQ(is.*value, by * (was.*value)) << name << j;
      }
      EXPECT_DOUBLE_EQ(larger.position_accuracy, factor * robot.position_accuracy);
    }
  }
}

TEST(Robot, ThePumaFollowsCraigsTable) {
  const Robot puma = load_robot("puma560");
  const LinkPoses at_zero = forward_kinematics(puma, Configuration::Zero(6));
  const Eigen::Vector3d shoulder(0.0, 0.0, 0.6718);
  // All joints at zero: the upper arm along x, the forearm straight down, a3 ahead of it; d3 to the side.
  EXPECT_LT((at_zero[3].translation() - shoulder - Eigen::Vector3d(0.4318, 0.1501, 0.0)).norm(), 1e-9);
  EXPECT_LT((at_zero[6].translation() - shoulder - Eigen::Vector3d(0.4318 + 0.0203, 0.1501, -0.4331)).norm(),
            1e-9);
  Configuration straight = Configuration::Zero(6);
  straight[2] = -std::numbers::pi / 2;
  EXPECT_LT((forward_kinematics(puma, straight)[6].translation() - shoulder -
             Eigen::Vector3d(0.4318 + 0.4331, 0.1501, 0.0203))
                .norm(),
            1e-9);
}

/// z axis of a Denavit-Hartenberg row (modified): Rx(alpha) Tx(a) Rz(theta) Tz(d), multiplied out by hand.
Eigen::Isometry3d modified_dh(double a, double alpha, double d, double theta) {
  const double ca = std::cos(alpha), sa = std::sin(alpha), ct = std::cos(theta), st = std::sin(theta);
  Eigen::Isometry3d row = Eigen::Isometry3d::Identity();
  row.matrix() << ct, -st, 0, a, st * ca, ct * ca, -sa, -d * sa, st * sa, ct * sa, ca, d * ca, 0, 0, 0, 1;
  return row;
}

TEST(Robot, ThePandaFollowsItsPublishedTableAndItsHomePoseTouchesNothing) {
  const Robot panda = load_robot("panda");
  ASSERT_EQ(panda.dof(), 7u);
  const double quarter = std::numbers::pi / 2;
  const double table[7][3] = {{0, 0, 0.333},        {0, -quarter, 0},           {0, quarter, 0.316},
                              {0.0825, quarter, 0}, {-0.0825, -quarter, 0.384}, {0, quarter, 0},
                              {0.088, quarter, 0}};
  Random random(2);
  for (int i = 0; i < 50; ++i) {
    const Configuration q = random.configuration(panda);
    Eigen::Isometry3d expected = Eigen::Isometry3d::Identity();
    for (int j = 0; j < 7; ++j)
      expected = expected * modified_dh(table[j][0], table[j][1], table[j][2], q[j]);
    expected = expected * modified_dh(0, 0, 0.107 + 0.1034, -quarter / 2);
    EXPECT_LT((tip_pose(panda, q).matrix() - expected.matrix()).norm(), 1e-9);
  }
  Configuration home(7);
  home << 0, -quarter / 2, 0, -1.5 * quarter, 0, quarter, quarter / 2;
  EXPECT_EQ(limit_violation(panda, home), "");
  EXPECT_TRUE(ConfigurationSpace(panda, Snapshot(), {.critical_by_default = false}).is_free(home));
  int touching = 0;
  const FclTruth truth(panda, {}, 0.05);
  for (int i = 0; i < 2'000; ++i) {
    touching += truth.touches_itself(forward_kinematics(panda, random.configuration(panda)));
  }
  EXPECT_GT(touching, 100);  // hand against forearm, foot, shoulder
  EXPECT_LT(touching, 400);  // and nothing that always touches
}

TEST(Robot, BetweenTheOpenFingersOfThePandaThereIsRoomAndNoneInThem) {
  const Robot panda = load_robot("panda");
  const Body* const hand = &*std::find_if(panda.bodies.begin(), panda.bodies.end(),
                                          [](const Body& body) { return body.part == "hand"; });
  const auto inside = [&](double y, double z) {  // of the hand's frame
    return std::any_of(hand, panda.bodies.data() + panda.bodies.size(), [&](const Body& body) {
      const Eigen::Vector3d at = body.link_from_shape.inverse() * Eigen::Vector3d(0.0, y, z);
      return body.shape.signed_distance(at) <= 0.0;
    });
  };
  for (double z = 0.07; z < 0.11; z += 0.005) {
    for (const double side : {-1.0, 1.0}) {
      EXPECT_FALSE(inside(side * 0.039, z)) << z;  // a thing of 78 mm fits
      EXPECT_TRUE(inside(side * 0.045, z)) << z;
    }
    EXPECT_FALSE(inside(0.0, z)) << z;
  }
  EXPECT_TRUE(inside(0.0, 0.06));
  EXPECT_TRUE(inside(0.1, 0.06));
  EXPECT_FALSE(inside(0.045, 0.115));
}

TEST(Robot, TheSixJointArmFollowsItsPublishedTableAndConsistsOfSpheres) {
  const Robot arm = load_robot("arm6");
  ASSERT_EQ(arm.dof(), 6u);
  const double quarter = std::numbers::pi / 2;
  const double table[6][3] = {{0, quarter, 0.089159}, {-0.425, 0, 0},         {-0.39225, 0, 0},
                              {0, quarter, 0.10915},  {0, -quarter, 0.09465}, {0, 0, 0.0823}};  // a, alpha, d
  Random random(3);
  for (int i = 0; i < 50; ++i) {
    const Configuration q = random.configuration(arm);
    Eigen::Isometry3d expected = Eigen::Isometry3d::Identity();
    for (int j = 0; j < 6; ++j) {  // standard rows: Rz(theta) Tz(d), then Tx(a) Rx(alpha)
      expected =
          expected * modified_dh(0, 0, table[j][2], q[j]) * modified_dh(table[j][0], table[j][1], 0, 0);
    }
    expected = expected * Eigen::Translation3d(0, 0, 0.13);
    EXPECT_LT((tip_pose(arm, q).matrix() - expected.matrix()).norm(), 1e-9);
  }
  for (const Body& body : arm.bodies) EXPECT_EQ(body.shape.kind(), Shape::Kind::sphere) << body.part;
  Configuration up(6);
  up << 0, -quarter, 0.3, -quarter, -quarter, 0;
  EXPECT_TRUE(ConfigurationSpace(arm, Snapshot(), {.critical_by_default = false}).is_free(up));
  int touching = 0;
  const FclTruth truth(arm, {}, 0.05);
  for (int i = 0; i < 2'000; ++i)
    touching += truth.touches_itself(forward_kinematics(arm, random.configuration(arm)));
  EXPECT_GT(touching, 100);   // gripper against upper arm and shoulder
  EXPECT_LT(touching, 1200);  // and nothing that always touches
}

TEST(Robot, ScalingScalesEveryLengthAndMassesWithTheCube) {
  const Robot full = load_robot("puma560"), small = scaled(full, 0.1),
              miniature = load_robot("puma560_miniature");
  Random random(1);
  for (int i = 0; i < 100; ++i) {
    const Configuration q = random.configuration(full);
    const LinkPoses a = forward_kinematics(full, q), b = forward_kinematics(small, q),
                    c = forward_kinematics(miniature, q);
    for (std::size_t k = 0; k < a.size(); ++k) {
      EXPECT_LT((0.1 * a[k].translation() - b[k].translation()).norm(), 1e-12);
      EXPECT_LT((c[k].matrix() - b[k].matrix()).norm(), 1e-12);
    }
  }
  for (std::size_t i = 0; i < full.bodies.size(); ++i) {
    EXPECT_NEAR(small.bodies[i].shape.bounding_radius(), 0.1 * full.bodies[i].shape.bounding_radius(), 1e-12);
    EXPECT_NEAR(small.bodies[i].cover[0].radius, 0.1 * full.bodies[i].cover[0].radius, 1e-12);
  }
  EXPECT_NEAR(small.links[2].mass, 0.001 * full.links[2].mass, 1e-12);
  EXPECT_DOUBLE_EQ(small.scale, 0.1);
  const Robot point = scaled(load_robot("point"), 2.0);
  EXPECT_DOUBLE_EQ(point.joints[0].upper, 200.0);
  EXPECT_DOUBLE_EQ(point.joints[0].step, 0.1);
  EXPECT_THROW(scaled(full, 0.0), std::invalid_argument);
}

}  // namespace robot_test
}  // namespace clearway
