#include "planning/robot/mimic_joints.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "mapping/system/random_unit.hpp"
#include "planning/check/path_check.hpp"
#include "planning/robot/arm_kinematics.hpp"
#include "planning/robot/kinematics.hpp"
#include "planning/robot/load.hpp"
#include "planning/robot/reach.hpp"
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
            "r.urdf: joint 'finger' mimics 'stiff', which is fixed: expected a joint that moves");
  EXPECT_EQ(with(mimic("finger"), mimic("thumb")),
            "r.urdf: joint 'thumb' mimics 'finger', which in turn follows it: expected one that moves");
  EXPECT_EQ(with("", mimic("thumb"), "prismatic"), "accepted");
  EXPECT_EQ(with("", mimic("thumb", "multiplier='2e-6'"), "prismatic"), "accepted");
  EXPECT_EQ(
      with("", mimic("thumb", "multiplier='2e-7'"), "prismatic"),
      "r.urdf: joint 'finger': <mimic> has multiplier '2e-7', expected a factor of at least 0.000001, or "
      "as far below 0");
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

/// A finger that slides at most 0.04 and follows the other at its double.
TEST(MimicJoints, ALimitThatAFollowerSetsNamesTheFollower) {
  const std::string ball = "<sphere radius='0.01'/>";
  const auto violation = [&](const std::string& own, const std::string& mimic, double value) {
    const worlds::UrdfRobot hand(
        "hand", worlds::urdf_link("palm", "0 0 0", ball) + worlds::urdf_link("a", "0 0 0", ball) +
                    worlds::urdf_link("b", "0 0 0", ball) +
                    worlds::urdf_joint("finger_1", "prismatic", "palm", "a", "0 0.1 0", "0 1 0", own) +
                    worlds::urdf_joint("finger_2", "prismatic", "palm", "b", "0 -0.1 0", "0 1 0",
                                       worlds::urdf_limit(-0.01, 0.04) + mimic));
    const Configuration q = Configuration::Constant(1, value);
    const std::string checked = check_path(hand.robot(), Snapshot(), {}, 0.0, {q}).first_contact;
    const std::string said = limit_violation(hand.robot(), q),
                      why = said.substr(std::min(said.find(", as"), said.size()));
    EXPECT_NE(checked.find("outside its limits"), std::string::npos) << checked;
    EXPECT_TRUE(checked.ends_with(why)) << checked;
    EXPECT_EQ(checked.find("follows") == std::string::npos, why.empty()) << checked;
    return why;
  };
  const std::string twice = "<mimic joint='finger_1' multiplier='2'/>",
                    back = "<mimic joint='finger_1' multiplier='-1'/>";
  EXPECT_EQ(violation(worlds::urdf_limit(0, 0.1), twice, 0.03),
            ", as joint 'finger_2' follows 'finger_1' and ends at 0.04 m");
  EXPECT_EQ(violation(worlds::urdf_limit(0, 0.1), back, 0.03),
            ", as joint 'finger_2' follows 'finger_1' and ends at -0.01 m");
  EXPECT_EQ(violation(worlds::urdf_limit(0, 0.1), twice, -0.01), "");
  EXPECT_EQ(violation(worlds::urdf_limit(0, 0.015), twice, 0.03), "");
}

/// A slide that follows a drive at 0.05 m per rad, and a knuckle that follows a slide at 20 rad per m.
TEST(MimicJoints, LimitsOfAFollowerOfAnotherKindAreInItsOwnUnits) {
  const std::string ball = "<sphere radius='0.01'/>";
  const auto master = [&](const std::string& first, const std::string& own, const std::string& second,
                          const std::string& mimic) {
    const worlds::UrdfRobot hand(
        "hand", worlds::urdf_link("palm", "0 0 0", ball) + worlds::urdf_link("a", "0 0 0", ball) +
                    worlds::urdf_link("b", "0 0 0", ball) +
                    worlds::urdf_joint("drive", first, "palm", "a", "0 0 0", "0 1 0", own) +
                    worlds::urdf_joint("slide", second, "palm", "b", "0 0 0", "0 1 0", mimic));
    return hand.robot();
  };
  const Robot turned = master("revolute", worlds::urdf_limit(-2, 2), "prismatic",
                              "<limit lower='0' upper='0.05' effort='1' velocity='0.02'/>"
                              "<mimic joint='drive' multiplier='0.05' offset='0.01'/>");
  EXPECT_NEAR(turned.joints[0].lower, -0.2, 1e-12);
  EXPECT_NEAR(turned.joints[0].upper, 0.8, 1e-12);
  EXPECT_NEAR(turned.joints[0].max_velocity, 0.4, 1e-12);
  EXPECT_EQ(
      limit_violation(turned, Configuration::Constant(1, 0.9)),
      "joint drive is 0.9 rad, above its upper limit 0.8 rad, as joint 'slide' follows 'drive' and ends "
      "at 0.05 m");
  const Robot slid = master("prismatic", worlds::urdf_limit(0, 0.1), "revolute",
                            worlds::urdf_limit(-1, 1) + "<mimic joint='drive' multiplier='20'/>");
  EXPECT_NEAR(slid.joints[0].upper, 0.05, 1e-12);
  EXPECT_NEAR(slid.joints[0].max_velocity, 0.05, 1e-12);
  const Robot endless = master("continuous", "", "prismatic",
                               worlds::urdf_limit(-1, 1) + "<mimic joint='drive' multiplier='1'/>");
  EXPECT_EQ(endless.joints[0].upper, 1.0);
  Robot unlimited = endless;  // whole turns of a joint that a slide follows do not lead back
  unlimited.joints[0].lower = -HUGE_VAL, unlimited.joints[0].upper = HUGE_VAL;
  EXPECT_FALSE(repeats_after_turns(unlimited, 0));
  unlimited.links[2].own_kind.reset();
  EXPECT_TRUE(repeats_after_turns(unlimited, 0));
}

/// Angles stay, lengths grow by the factor, whichever of a joint and its follower slides.
TEST(MimicJoints, OfAnotherKindScaleAsLengthsAndAngles) {
  const worlds::UrdfRobot rack = worlds::rack_and_pinion();
  const Robot& robot = rack.robot();
  for (const double factor : {0.5, 3.0}) {
    const Robot larger = scaled(robot, factor);
    const Eigen::Vector2d q(0.7, 0.1);
    const LinkPoses was = forward_kinematics(robot, q),
                    is = forward_kinematics(larger, Eigen::Vector2d(0.7, factor * 0.1));
    for (std::size_t i = 0; i < was.size(); ++i) {
      EXPECT_TRUE(is[i].linear().isApprox(was[i].linear(), 1e-12)) << robot.links[i].name;
      EXPECT_LT((is[i].translation() - factor * was[i].translation()).norm(), 1e-12) << robot.links[i].name;
    }
  }
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

/// Arms with followers about axes of their own, in frames that are turned as CAD programs write them.
worlds::UrdfRobot drawn_followers(std::mt19937_64& random) {
  const auto number = [&](double most) { return std::to_string(most * (2.0 * random_unit(random) - 1.0)); };
  const auto three = [&](double most) { return number(most) + " " + number(most) + " " + number(most); };
  const std::string ball = "<sphere radius='0.02'/>", wide = worlds::urdf_limit(-2, 2);
  std::string elements = worlds::urdf_link("base", "0 0 0", ball), parent = "base";
  const auto any_kind = [&] { return random() % 3 == 0 ? "prismatic" : "revolute"; };
  for (const std::string link : {"a", "b", "c", "d"}) {
    const bool follows = link == "b" || link == "d";
    const std::string mimic =
        follows ? "<mimic joint='a' multiplier='" + number(2) + "' offset='" + number(0.2) + "'/>" : "";
    elements += worlds::urdf_link(link, three(0.2), ball) +
                worlds::urdf_joint(link, follows || link == "a" ? any_kind() : "revolute", parent, link,
                                   three(0.3) + "' rpy='" + three(3), three(1), wide + mimic);
    parent = link;
  }
  return worlds::UrdfRobot("drawn", elements);
}

Eigen::Matrix4d by_differences(const Robot& robot, int link, const Configuration& q, Eigen::Index joint) {
  constexpr double step = 1e-6;
  Configuration before = q, after = q;
  before[joint] -= step;
  after[joint] += step;
  const auto at = static_cast<std::size_t>(link);
  return (forward_kinematics(robot, after)[at].matrix() - forward_kinematics(robot, before)[at].matrix()) /
         (2.0 * step);
}

/// The check compares the pose of every link with KDL's; the Jacobian is that of differences.
TEST(MimicJoints, FollowersAboutOtherAxesHaveTheFramesOfTheirFile) {
  std::mt19937_64 random(3);
  for (int trial = 0; trial < 30; ++trial) {
    const worlds::UrdfRobot arm = drawn_followers(random);
    const Robot& robot = arm.robot();
    ASSERT_EQ(robot.dof(), 2U);
    const Configuration q = 0.1 * Configuration::Random(2);
    const PathVerdict check = check_path(robot, Snapshot(), {}, 0.0, {q, q + 0.01 * Configuration::Ones(2)});
    EXPECT_EQ(check.first_contact.find("is not what its file"), std::string::npos) << check.first_contact;
    const LinkPoses poses = forward_kinematics(robot, q);
    ArmKinematics fast(robot);
    fast.place(q);
    for (std::size_t i = 0; i < poses.size(); ++i) {
      EXPECT_TRUE(fast.map_from_link()[i].isApprox(poses[i], 1e-12));
      const auto columns = jacobian(robot, poses, static_cast<int>(i), poses[i].translation());
      for (Eigen::Index joint = 0; joint < 2; ++joint) {
        const Eigen::Matrix4d rate = by_differences(robot, static_cast<int>(i), q, joint);
        const Eigen::Matrix3d turn = rate.topLeftCorner<3, 3>() * poses[i].linear().transpose();
        EXPECT_LT((columns.col(joint).head<3>() - rate.topRightCorner<3, 1>()).norm(), 1e-8);
        EXPECT_LT((columns.col(joint).tail<3>() - Eigen::Vector3d(turn(2, 1), turn(0, 2), turn(1, 0))).norm(),
                  1e-8);
      }
    }
    for (const Body& body : robot.bodies) {  // its box of reach holds it wherever the joints are
      const Eigen::AlignedBox3d reach = reach_box(robot, body);
      for (int draw = 0; draw < 20; ++draw) {
        Configuration any(2);
        for (Eigen::Index j = 0; j < 2; ++j) {
          const Joint& joint = robot.joints[static_cast<std::size_t>(j)];
          any[j] = joint.lower + random_unit(random) * (joint.upper - joint.lower);
        }
        const Eigen::Vector3d at =
            (forward_kinematics(robot, any)[static_cast<std::size_t>(body.link)] * body.link_from_shape)
                .translation();
        EXPECT_LT(reach.exteriorDistance(at), 1e-9);
      }
    }
  }
}

/// A load hangs where the frame of its link is: a levelling wrist, whose joint's axis has another direction
/// in its own frame than its master's.
TEST(MimicJoints, ALoadOnAFollowerIsWhereItsFrameIs) {
  const std::string ball = "<sphere radius='0.02'/>", wide = worlds::urdf_limit(-2, 2);
  const worlds::UrdfRobot level(
      "level",
      worlds::urdf_link("base", "0 0 0", ball) + worlds::urdf_link("arm", "0.5 0 0", ball) +
          worlds::urdf_link("wrist", "0 0 0", ball) +
          worlds::urdf_joint("lift", "revolute", "base", "arm", "0 0 0", "0 0 1", wide) +
          worlds::urdf_joint("level", "revolute", "arm", "wrist", "1 0 0' rpy='1.5707963267948966 0 0",
                             "0 1 0", wide + "<mimic joint='lift' multiplier='-1'/>"));
  Load bar;
  bar.name = "bar";
  bar.link = "wrist";
  bar.shape = Shape::box({0.01, 0.01, 0.4});  // along z of the wrist, which is -y of the map for ever
  bar.link_from_load.translation() = Eigen::Vector3d(0, 0, 0.3);
  const Robot robot = with_load(level.robot(), bar);
  for (const double q : {-1.0, 0.0, 0.7}) {
    const LinkPoses poses = forward_kinematics(robot, Configuration::Constant(1, q));
    const Body& body = robot.bodies.back();
    const Eigen::Isometry3d at = poses[static_cast<std::size_t>(body.link)] * body.link_from_shape;
    EXPECT_LT((at.translation() - Eigen::Vector3d(std::cos(q), std::sin(q) - 0.3, 0.0)).norm(), 1e-12);
    EXPECT_LT((at.linear().col(2) + Eigen::Vector3d::UnitY()).norm(), 1e-12);
  }
}

/// Axes that are opposite but for digits, and others.
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
