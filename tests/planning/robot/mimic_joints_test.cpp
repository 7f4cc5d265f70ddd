#include "planning/robot/mimic_joints.hpp"

#include <gtest/gtest.h>

#include "planning/check/path_check.hpp"
#include "planning/robot/kinematics.hpp"
#include "tests/worlds/hostile_robots.hpp"
#include "tests/worlds/urdf_robots.hpp"

namespace clearway {
namespace mimic_joints_test {

TEST(MimicJoints, MastersThatCannotBeFollowedAreNamed) {
  const RobotFolder folder;
  const auto with = [&](const std::string& first, const std::string& second,
                        const std::string& type = "revolute") {
    const std::string limit = "<axis xyz='0 0 1'/><limit lower='-1' upper='1' effort='1' velocity='1'/>";
    return folder.refusal(
        "<robot name='r'><link name='base'/><link name='a'>" + sphere_collision() +
        "</link><link name='b'/><link name='c'/><joint name='thumb' type='revolute'><parent "
        "link='base'/><child link='a'/>" +
        limit + first + "</joint><joint name='finger' type='" + type +
        "'><parent link='a'/><child link='b'/>" + limit + second +
        "</joint><joint name='stiff' type='fixed'><parent link='b'/><child link='c'/></joint></robot>");
  };
  const auto mimic = [](const std::string& master, const std::string& rest = "") {
    return "<mimic joint='" + master + "' " + rest + "/>";
  };
  EXPECT_EQ(with("", mimic("thumb")), "accepted");
  EXPECT_EQ(with("", mimic("thumb", "multiplier='-1' offset='0.1'")), "accepted");
  EXPECT_EQ(with("", mimic("finger")),
            "r.urdf: joint 'finger' mimics 'finger', itself: expected another joint");
  EXPECT_EQ(with("", mimic("thunb")),
            "r.urdf: joint 'finger' mimics 'thunb', which is no joint that moves, did you mean 'thumb'?");
  EXPECT_EQ(with("", mimic("stiff")),
            "r.urdf: joint 'finger' mimics 'stiff', which is no joint that moves, did you mean 'thumb'?");
  EXPECT_EQ(with(mimic("finger"), mimic("thumb")),
            "r.urdf: joint 'thumb' mimics 'finger', which in turn follows it: expected one that moves");
  EXPECT_EQ(
      with("", mimic("thumb"), "prismatic"),
      "r.urdf: joint 'finger' mimics 'thumb', expected a joint of the same kind: one of them turns and the "
      "other slides");
  EXPECT_EQ(with("", mimic("thumb", "offset='5'")),
            "r.urdf: joint 'finger' mimics 'thumb' and is never within its own limits");
  for (const std::string factor : {"0", "1e-9", "-1e-200"}) {
    EXPECT_EQ(with("", mimic("thumb", "multiplier='" + factor + "'")),
              "r.urdf: joint 'finger': <mimic> has multiplier '" + factor +
                  "', expected a factor of at least 0.001, or as far below 0");
  }
  EXPECT_EQ(with("", mimic("thumb", "multiplier='1e9'")),
            "r.urdf: joint 'finger': <mimic> has multiplier '1e9', expected factors in [-1000, 1000]");
  EXPECT_EQ(
      with("", mimic("thumb", "multiplyer='2'")),
      "r.urdf: joint 'finger': <mimic> has an unknown attribute 'multiplyer', did you mean 'multiplier'?");
  EXPECT_EQ(with("", "<mimic/>"), "r.urdf: joint 'finger': <mimic joint=…> is missing");
}

/// A finger of three bones, as robot hands have them: the tip follows the middle, which follows the root.
TEST(MimicJoints, AFollowerOfAFollowerFollowsTheOneThatMoves) {
  const std::string ball = "<sphere radius='0.01'/>", wide = worlds::urdf_limit(-3, 3);
  const auto bone = [&](const char* parent, const char* child, const std::string& axis,
                        const std::string& mimic) {
    return worlds::urdf_link(child, "0.1 0 0", ball) +
           worlds::urdf_joint(child, "revolute", parent, child, "0.2 0 0", axis, wide + mimic);
  };
  const worlds::UrdfRobot finger(
      "finger", worlds::urdf_link("palm", "0 0 0", ball) +
                    bone("middle", "tip", "0 0 1", "<mimic joint='middle' multiplier='0.5' offset='-0.2'/>") +
                    bone("palm", "root", "0 0 1", "") +
                    bone("root", "middle", "0 0 -1", "<mimic joint='root' multiplier='2' offset='0.1'/>"));
  const Robot& robot = finger.robot();
  ASSERT_EQ(robot.dof(), 1U);
  EXPECT_DOUBLE_EQ(robot.joints[0].upper, 1.45);  // 2 q + 0.1 <= 3
  const double q = 0.3, middle = 2 * q + 0.1, tip = 0.5 * middle - 0.2;
  Eigen::Rotation2Dd turn(q);
  Eigen::Vector2d expected(0.2, 0);
  expected += turn * Eigen::Vector2d(0.2, 0);
  turn = turn * Eigen::Rotation2Dd(-middle);
  expected += turn * Eigen::Vector2d(0.2, 0);
  turn = turn * Eigen::Rotation2Dd(tip);
  expected += turn * Eigen::Vector2d(0.1, 0);
  const LinkPoses poses = forward_kinematics(robot, Configuration::Constant(1, q));
  for (const Body& body : robot.bodies) {
    if (body.part != "tip") continue;
    const Eigen::Vector3d at =
        poses[static_cast<std::size_t>(body.link)] * body.link_from_shape.translation();
    EXPECT_LT((at - Eigen::Vector3d(expected.x(), expected.y(), 0)).norm(), 1e-12);
  }
  const std::string said =
      check_path(robot, Snapshot(), {}, 0.0, {Configuration::Zero(1), Configuration::Ones(1)}).first_contact;
  EXPECT_EQ(said.find("is not what its file"), std::string::npos) << said;
}

TEST(MimicJoints, ItsOwnSpeedIsKept) {
  const auto speed = [](const std::string& own, const std::string& mimic) {
    const auto limit = [](const std::string& velocity) {
      return "<limit lower='-1' upper='1' effort='1' velocity='" + velocity + "'/>";
    };
    const worlds::UrdfRobot pair(
        "pair", worlds::urdf_link("base", "0 0 0", "<sphere radius='0.1'/>") +
                    worlds::urdf_link("a", "0.5 0 0", "<sphere radius='0.1'/>") +
                    worlds::urdf_link("b", "0.5 0.5 0.2", "<sphere radius='0.1'/>") +
                    worlds::urdf_joint("left", "revolute", "base", "a", "0 0 0", "0 0 1", limit("2")) +
                    worlds::urdf_joint("right", "revolute", "base", "b", "0 0 0", "0 0 1",
                                       limit(own) + "<mimic joint='left' " + mimic + "/>"));
    return pair.robot().joints.front().max_velocity;
  };
  EXPECT_EQ(speed("2", ""), 2.0);
  EXPECT_EQ(speed("0.5", ""), 0.5);
  EXPECT_EQ(speed("2", "multiplier='-4'"), 0.5);
  EXPECT_EQ(speed("2", "multiplier='0.5'"), 2.0);
  EXPECT_EQ(speed("0", "multiplier='4'"), 2.0);  // none is known
}

/// A follower's frame is turned so that its axis is its master's: its bodies stay where they are.
TEST(MimicJoints, AxesThatAreAlmostOppositeMoveNoBody) {
  for (const std::string axis : {"0 0 1", "0 0 -1", "1.5e-06 0 -1", "3.67e-06 0 -1", "1e-04 0 -1", "1 0 0"}) {
    const worlds::UrdfRobot pair(
        "pair",
        worlds::urdf_link("base", "0 0 0", "<sphere radius='0.1'/>") +
            worlds::urdf_link("a", "0.5 0 0", "<sphere radius='0.1'/>") +
            worlds::urdf_link("b", "0.5 0.5 0.2", "<sphere radius='0.1'/>") +
            worlds::urdf_joint("left", "revolute", "base", "a", "0 0 0", "0 0 1", worlds::urdf_limit(-1, 1)) +
            worlds::urdf_joint("right", "revolute", "base", "b", "0 0 0", axis,
                               worlds::urdf_limit(-1, 1) + "<mimic joint='left'/>"));
    const Robot& robot = pair.robot();
    const LinkPoses poses = forward_kinematics(robot, Configuration::Zero(1));
    const Body& body = robot.bodies.back();
    const Eigen::Vector3d at =
        (poses[static_cast<std::size_t>(body.link)] * body.link_from_shape).translation();
    EXPECT_LT((at - Eigen::Vector3d(0.5, 0.5, 0.2)).norm(), 1e-12) << axis;
  }
}

}  // namespace mimic_joints_test
}  // namespace clearway
