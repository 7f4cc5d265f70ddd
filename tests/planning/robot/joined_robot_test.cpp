#include "planning/robot/joined_robot.hpp"

#include <gtest/gtest.h>

#include <random>

#include "planning/check/path_check.hpp"
#include "planning/robot_files/load_robot.hpp"
#include "tests/worlds/voxel_scene.hpp"

namespace clearway {
namespace joined_robot_test {

Robot placed(const std::string& name, double x, double yaw) {
  Robot robot = load_robot(name);
  robot.map_from_base = Eigen::Translation3d(x, 0.1, 0.2) * Eigen::AngleAxisd(yaw, Eigen::Vector3d::UnitZ());
  return robot;
}

TEST(JoinedRobot, EveryLinkAndBodyIsWhereItsOwnRobotHasIt) {
  const Robot first = placed("arm5", 0.0, 0.3), second = placed("puma560", 1.4, 2.0);
  const Robot both = joined_robot({{"left", first}, {"right", second}});
  ASSERT_EQ(both.dof(), first.dof() + second.dof());
  ASSERT_EQ(both.bodies.size(), first.bodies.size() + second.bodies.size());
  std::mt19937_64 random(3);
  std::uniform_real_distribution<double> angle(-1.0, 1.0);
  for (int trial = 0; trial < 50; ++trial) {
    Configuration a(5), b(6);
    for (double& value : a) value = angle(random);
    for (double& value : b) value = angle(random);
    const LinkPoses all = forward_kinematics(both, joined({a, b}));
    const auto expect_alike = [&](const Robot& robot, const Configuration& q, std::size_t from) {
      const LinkPoses own = forward_kinematics(robot, q);
      for (std::size_t i = 0; i < robot.bodies.size(); ++i) {
        const Body &body = robot.bodies[i], &same = both.bodies[from + i];
        const Eigen::Isometry3d here = all[static_cast<std::size_t>(same.link)] * same.link_from_shape;
        EXPECT_TRUE(here.isApprox(own[static_cast<std::size_t>(body.link)] * body.link_from_shape, 1e-12));
      }
    };
    expect_alike(first, a, 0);
    expect_alike(second, b, first.bodies.size());
  }
  EXPECT_EQ(both.bodies.front().part, "left/" + first.bodies.front().part);
  EXPECT_EQ(both.joints.back().name, "right/" + second.joints.back().name);
}

TEST(JoinedRobot, TheCheckOfPathsSeesRobotsThatMeetHalfWay) {
  const Robot arm = placed("arm5", 0.0, 0.0), other = placed("arm5", 1.2, 3.141592653589793);
  const Robot both = joined_robot({{"left", arm}, {"right", other}});
  Configuration start(5), goal(5), away(5);
  start << -0.6, -0.3, 0.6, -0.3, 0.0;
  goal << 0.6, -0.3, 0.6, -0.3, 0.0;
  away << -0.6, -1.5, 0.6, -0.3, 0.0;
  const Snapshot nothing = VoxelScene{}.snapshot();
  const PathVerdict meet = check_path(both, nothing, {}, 0.0, {joined({start, start}), joined({goal, goal})});
  EXPECT_FALSE(meet.valid);
  EXPECT_NE(meet.first_contact.find("left/"), std::string::npos) << meet.first_contact;
  EXPECT_NE(meet.first_contact.find("right/"), std::string::npos) << meet.first_contact;
  const PathVerdict pass = check_path(both, nothing, {}, 0.0, {joined({start, away}), joined({goal, away})});
  EXPECT_TRUE(pass.valid) << pass.first_contact;
}

TEST(JoinedRobot, NamesMustDiffer) {
  const Robot arm = load_robot("arm5");
  EXPECT_THROW(joined_robot({{"left", arm}, {"left", arm}}), std::invalid_argument);
  EXPECT_THROW(joined_robot({}), std::invalid_argument);
}

}  // namespace joined_robot_test
}  // namespace clearway
