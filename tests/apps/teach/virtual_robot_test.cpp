#include "apps/teach/virtual_robot.hpp"

#include <gtest/gtest.h>

#include <set>

#include "planning/robot/kinematics.hpp"
#include "tests/datasets/complaint.hpp"

namespace clearway {
namespace virtual_robot_test {

VirtualRobot robot_of(const std::string& name, const std::vector<double>& near) {
  RobotChoice choice;
  choice.robot = name;
  return VirtualRobot(choice, near);
}

/// Which of `count` it says it is in, as it goes through all of them.
std::set<std::string> all_branches(VirtualRobot& robot, int count, bool keeps_turn) {
  const Eigen::Isometry3d before = tip_pose(robot.robot(), robot.q());
  const Configuration first = robot.q();
  std::set<std::string> names;
  for (int i = 0; i < count; ++i) {
    const Configuration last = robot.q();
    names.insert(robot.take_next_branch());
    EXPECT_GT((robot.q() - last).lpNorm<Eigen::Infinity>(), 0.01);
    const Eigen::Isometry3d now = tip_pose(robot.robot(), robot.q());
    EXPECT_LT((now.translation() - before.translation()).norm(), 1e-4);
    EXPECT_TRUE(!keeps_turn || now.linear().isApprox(before.linear(), 1e-4));
  }
  EXPECT_LT((robot.q() - first).lpNorm<Eigen::Infinity>(), 1e-3);  // round once
  return names;
}

TEST(VirtualRobot, GoesThroughTheBranchesOfAPumaAndKeepsItsTip) {
  VirtualRobot robot = robot_of("puma560", {0.3, -0.8, 0.4, 0.5, 0.6, 0.2});
  const std::string first = robot.take_next_branch();
  const int count = std::stoi(first.substr(first.find("of ") + 3));
  EXPECT_GE(count, 2);
  VirtualRobot again = robot_of("puma560", {0.3, -0.8, 0.4, 0.5, 0.6, 0.2});
  EXPECT_EQ(all_branches(again, count, true).size(), static_cast<std::size_t>(count));
}

TEST(VirtualRobot, BendsThePlanarElbowTheOtherWay) {
  VirtualRobot robot = robot_of("planar2", {0.4, 0.6});
  EXPECT_EQ(all_branches(robot, 2, false), (std::set<std::string>{"1 of 2", "2 of 2"}));
}

/// The next pose is followed from there, so that the arm configuration stays.
TEST(VirtualRobot, FollowsTheProbeInItsNewBranch) {
  VirtualRobot robot = robot_of("planar2", {0.4, 0.6});
  robot.take_next_branch();
  EXPECT_NEAR(robot.q()[1], -0.6, 1e-3);
  robot.lead(tip_pose(robot.robot(), Eigen::Vector2d(0.42, 0.6)), 1.0);
  EXPECT_EQ(robot.not_there(1.0), "");
  EXPECT_NEAR(robot.q()[1], -0.6, 0.02);
}

TEST(VirtualRobot, SaysWhereThereIsNoOtherBranch) {
  VirtualRobot point = robot_of("point", {0.1, 0.2});
  EXPECT_EQ(complaint([&] { point.take_next_branch(); }), "no other arm configuration has the tip there");
  VirtualRobot floats = robot_of("panda", {0.1, -0.6, 0.2, -2.0, 0.1, 1.5, 0.7});
  EXPECT_NE(complaint([&] { floats.take_next_branch(); }).find("no separate arm configurations"),
            std::string::npos);
  VirtualRobot nowhere = robot_of("planar2", {});
  EXPECT_NE(complaint([&] { nowhere.take_next_branch(); }).find("stands nowhere yet"), std::string::npos);
}

}  // namespace virtual_robot_test
}  // namespace clearway
