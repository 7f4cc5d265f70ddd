#include "planning/robot/bring_point.hpp"

#include <gtest/gtest.h>

#include "planning/robot_files/load_robot.hpp"
#include "tests/worlds/random_world.hpp"

namespace clearway {
namespace bring_point_test {

Eigen::Vector3d place(const Robot& robot, const PointTarget& wanted, const Configuration& q) {
  return forward_kinematics(robot, q)[static_cast<std::size_t>(wanted.link)] * wanted.point;
}

bool is_within_limits(const Robot& robot, const Configuration& q) {
  for (std::size_t j = 0; j < robot.dof(); ++j) {
    const double value = q[static_cast<Eigen::Index>(j)];
    if (value < robot.joints[j].lower || value > robot.joints[j].upper) return false;
  }
  return true;
}

TEST(BringPoint, BringsPointsWithinReachToTheirPlaceAndKeepsLimits) {
  LinkPoses poses;
  for (const char* name : {"puma560", "panda", "arm5"}) {
    const Robot robot = load_robot(name);
    Random random(7);
    int there = 0;
    for (int i = 0; i < 200; ++i) {
      PointTarget wanted{robot.tip_link, random.point(0.1), Eigen::Vector3d::Zero(), 1e-4};
      wanted.target = place(robot, wanted, random.configuration(robot));
      Configuration q = random.configuration(robot);
      const bool is_there = bring_point(robot, wanted, 50, q, poses);
      ASSERT_TRUE(is_within_limits(robot, q)) << name;
      ASSERT_EQ(is_there, (place(robot, wanted, q) - wanted.target).norm() <= 1e-4) << name;
      there += is_there;
    }
    EXPECT_GE(there, 100) << name;
  }
}

TEST(BringPoint, MovesNoFartherThanOtherWaysOfGoingThere) {
  const Robot robot = load_robot("panda");
  Random random(8);
  LinkPoses poses;
  for (int i = 0; i < 50; ++i) {
    // A small motion of the joints, half of which does not move the point: the least one is shorter.
    const Configuration from = 0.8 * random.configuration(robot), drawn = random.configuration(robot);
    const Configuration other = from + 0.02 * (drawn - from);
    PointTarget wanted{robot.tip_link, Eigen::Vector3d(0.0, 0.0, 0.1), Eigen::Vector3d::Zero(), 1e-6};
    wanted.target = place(robot, wanted, other);
    Configuration q = from;
    if (!bring_point(robot, wanted, 50, q, poses)) continue;
    EXPECT_LE((q - from).norm(), 1.02 * (other - from).norm());
  }
}

TEST(BringPoint, SaysSoWhenThePlaceIsOutOfReach) {
  const Robot robot = load_robot("puma560");
  Configuration q = Configuration::Zero(6);
  LinkPoses poses;
  EXPECT_FALSE(
      bring_point(robot, {robot.tip_link, Eigen::Vector3d::Zero(), {9.0, 0.0, 0.0}, 1e-3}, 50, q, poses));
  EXPECT_TRUE(is_within_limits(robot, q));
}

}  // namespace bring_point_test
}  // namespace clearway
