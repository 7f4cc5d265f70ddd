#include "planning/robot/goal_configurations.hpp"

#include <gtest/gtest.h>

#include <Eigen/SVD>
#include <algorithm>
#include <cmath>
#include <numbers>

#include "planning/robot/held_joints.hpp"
#include "planning/robot_files/load_robot.hpp"
#include "tests/worlds/random_world.hpp"
#include "tests/worlds/urdf_robots.hpp"

namespace clearway {
namespace goal_configurations_test {

TEST(GoalConfigurations, EachPutsTheTipThereWithinLimitsAndTheNearestIsFirst) {
  Random random(1);
  for (const char* name : {"panda", "puma560", "arm6"}) {
    const Robot robot = load_robot(name);
    int reached = 0;
    for (int round = 0; round < 8; ++round) {
      const Configuration there = random.configuration(robot), near = random.configuration(robot);
      const Eigen::Isometry3d pose = tip_pose(robot, there);
      const auto found = goal_configurations(robot, pose, near);
      reached += !found.empty();
      double last = 0.0;
      for (const Configuration& q : found) {
        EXPECT_EQ(limit_violation(robot, q), "");
        const Eigen::Isometry3d at = tip_pose(robot, q);
        EXPECT_LT((at.translation() - pose.translation()).norm(), 1e-5) << name;
        EXPECT_LT((at.linear() - pose.linear()).norm(), 1e-5) << name;
        const double apart = (q - near).lpNorm<Eigen::Infinity>();
        EXPECT_GE(apart, last);
        last = apart;
      }
      for (std::size_t i = 0; i < found.size(); ++i)
        for (std::size_t k = i + 1; k < found.size(); ++k)
          EXPECT_GT((found[i] - found[k]).lpNorm<Eigen::Infinity>(), 1e-3);
      const std::size_t least = std::string(name) == "panda" ? 1 : 2;  // of arm, elbow and wrist
      EXPECT_GE(found.size(), least) << name;
    }
    EXPECT_EQ(reached, 8) << name;
  }
}

/// The joints of arms as UR's turn twice: each pose has many turns, and a planner wants the nearest.
TEST(GoalConfigurations, JointsThatTurnTwiceAreTurnedNearToTheGivenOnes) {
  Robot robot = load_robot("arm6");
  for (Joint& joint : robot.joints)
    joint.lower = -2.0 * std::numbers::pi, joint.upper = 2.0 * std::numbers::pi;
  Random random(4);
  int found = 0;
  for (int round = 0; round < 6; ++round) {
    const Configuration near = 0.4 * random.configuration(robot);
    for (const Configuration& q :
         goal_configurations(robot, tip_pose(robot, random.configuration(robot)), near)) {
      EXPECT_LE((q - near).lpNorm<Eigen::Infinity>(), std::numbers::pi + 1e-9);
      ++found;
    }
  }
  EXPECT_GT(found, 12);
}

bool holds(const std::vector<Configuration>& found, const Configuration& q) {
  return std::any_of(found.begin(), found.end(), [&](const Configuration& other) {
    return (q - other).lpNorm<Eigen::Infinity>() < 1e-3;
  });
}

/// A spherical wrist that no setting says: all branches of the closed form.
TEST(GoalConfigurations, OfASphericalWristAllBranchesAreFound) {
  const Robot closed = load_robot("puma560");
  Robot numeric = closed;
  numeric.inverse_kinematics = "numeric";
  Random random(3);
  std::size_t branches = 0;
  for (int i = 0; i < 60; ++i) {
    const Eigen::Isometry3d pose = tip_pose(closed, random.configuration(closed));
    const Configuration near = random.configuration(closed);
    const auto found = goal_configurations(numeric, pose, near);
    for (const Configuration& branch : goal_configurations(closed, pose, near)) {
      EXPECT_TRUE(holds(found, branch)) << i << ": " << branch.transpose();
      ++branches;
    }
  }
  EXPECT_GT(branches, 240U);
}

/// Six joints; the last three axes meet at 0.3 m along the forearm, at odd angles, and the tip is aside.
worlds::UrdfRobot oblique_arm() {
  using namespace worlds;
  const std::string limit = urdf_limit(-3.1, 3.1);
  std::string text = "<link name='base'/>";
  for (int i = 1; i <= 6; ++i) text += "<link name='l" + std::to_string(i) + "'/>";
  const std::string part =
      "<link name='tool'><collision><geometry><sphere radius='0.02'/></geometry></collision></link>";
  return {"oblique", text + part + urdf_joint("a", "revolute", "base", "l1", "0 0 0.3", "0.1 0 1", limit) +
                         urdf_joint("b", "revolute", "l1", "l2", "0.05 0.1 0.1", "0 1 0.2", limit) +
                         urdf_joint("c", "revolute", "l2", "l3", "0.02 0 0.4", "0.3 1 0", limit) +
                         urdf_joint("d", "revolute", "l3", "l4", "0 0 0.3", "0.3 0.1 1", limit) +
                         urdf_joint("e", "revolute", "l4", "l5", "0 0 0", "0.2 1 0.1", limit) +
                         urdf_joint("f", "revolute", "l5", "l6", "0 0 0", "1 0.3 0.6", limit) +
                         urdf_joint("g", "fixed", "l6", "tool", "0.03 0.02 0.1", "0 0 1", "")};
}

TEST(GoalConfigurations, AnArmIsFoundWhereItIsHoweverItsWristIsMade) {
  const worlds::UrdfRobot oblique = oblique_arm();
  Random random(4);
  std::size_t several = 0, singular = 0;
  for (int i = 0; i < 100; ++i) {
    const Configuration q = random.configuration(oblique.robot()),
                        near = random.configuration(oblique.robot());
    const Eigen::Isometry3d pose = tip_pose(oblique.robot(), q);
    const auto found = goal_configurations(oblique.robot(), pose, near);
    const LinkPoses links = forward_kinematics(oblique.robot(), q);
    const auto moves = jacobian(oblique.robot(), links, oblique.robot().tip_link, pose.translation());
    const bool is_singular = Eigen::JacobiSVD<Eigen::MatrixXd>(moves).singularValues().minCoeff() < 1e-3;
    singular += is_singular;  // many configurations are there, to 1e-6 m and rad
    EXPECT_TRUE(is_singular || holds(found, q)) << i << ": " << q.transpose();
    for (const Configuration& other : found)
      EXPECT_TRUE(tip_pose(oblique.robot(), other).isApprox(pose, 1e-5));
    several += found.size() >= 2;
  }
  EXPECT_GT(several, 80U);
  EXPECT_LT(singular, 10U);
}

TEST(GoalConfigurations, NothingIsFoundOutOfReach) {
  const Robot robot = load_robot("panda");
  Eigen::Isometry3d far = Eigen::Isometry3d::Identity();
  far.translation().x() = 5.0;
  EXPECT_TRUE(goal_configurations(robot, far, Configuration::Zero(7), 4).empty());
}

TEST(GoalConfigurations, ConfigurationsOfAnotherSizeAreRefused) {
  const Robot robot = load_robot("panda");
  const Eigen::Isometry3d pose = tip_pose(robot, Configuration::Zero(7));
  Configuration lost = Configuration::Zero(7);
  lost[3] = std::nan("");
  for (const Configuration& near : {Configuration(), Configuration(Configuration::Zero(6)), lost}) {
    EXPECT_THROW(goal_configurations(robot, pose, near, 4), std::invalid_argument);
    EXPECT_THROW(goal_configurations(robot, GoalPose{pose, 0.01}, near, 4), std::invalid_argument);
  }
  EXPECT_THROW(inverse_kinematics(robot, pose, Configuration::Zero(6)), std::invalid_argument);
  EXPECT_FALSE(inverse_kinematics(robot, pose, lost));
}

TEST(GoalPose, PosesOfItKeepWhatItAsksForAndSpreadOverIt) {
  Random random(5);
  for (int round = 0; round < 40; ++round) {
    GoalPose goal{random.pose(1.0), round % 2 * 0.05 * random.unit(), round % 3 * random.unit()};
    if (round % 5 > 1) goal.free_axis = round % 3;
    const auto poses = poses_of(goal);
    EXPECT_TRUE(poses.front().isApprox(goal.map_from_tip, 0.0));
    EXPECT_EQ(poses.size(), 1U + (goal.free_axis ? 23U : 0U) +
                                (goal.position_tolerance > 0.0 || goal.turn_tolerance > 0.0 ? 96U : 0U));
    double farthest = 0.0, widest = 0.0, most = 0.0;
    for (const Eigen::Isometry3d& pose : poses) {
      EXPECT_TRUE(reaches(goal, pose));
      EXPECT_TRUE((pose.linear() * pose.linear().transpose()).isIdentity(1e-9));
      farthest = std::max(farthest, (pose.translation() - goal.map_from_tip.translation()).norm());
      const Eigen::Matrix3d apart = goal.map_from_tip.linear().transpose() * pose.linear();
      most = std::max(most, Eigen::AngleAxisd(apart).angle());
      if (!goal.free_axis) continue;
      const int axis = *goal.free_axis;  // the angle between the axis here and there
      widest = std::max(widest, std::acos(std::clamp(apart(axis, axis), -1.0, 1.0)));
    }
    EXPECT_GE(farthest, 0.9 * goal.position_tolerance);
    EXPECT_LE(farthest, goal.position_tolerance + 1e-12);
    if (goal.free_axis) {
      EXPECT_LE(widest, goal.turn_tolerance + 1e-7);
      EXPECT_GT(most, 3.1) << "half a turn about the axis";
    } else {
      EXPECT_LE(most, goal.turn_tolerance + 1e-7);
      EXPECT_GE(most, 0.9 * goal.turn_tolerance);
    }
  }
}

TEST(GoalPose, WhatLiesBeyondItsTolerancesIsNotReached) {
  GoalPose goal{Eigen::Isometry3d::Identity(), 0.01, 0.1};
  const auto tip = [](double x, double angle, const Eigen::Vector3d& axis) {
    Eigen::Isometry3d pose(Eigen::AngleAxisd(angle, axis));
    pose.translation().x() = x;
    return pose;
  };
  EXPECT_TRUE(reaches(goal, tip(0.0099, 0.099, Eigen::Vector3d::UnitX())));
  EXPECT_FALSE(reaches(goal, tip(0.0101, 0.0, Eigen::Vector3d::UnitX())));
  EXPECT_FALSE(reaches(goal, tip(0.0, 0.101, Eigen::Vector3d::UnitZ())));
  goal.free_axis = 2;
  EXPECT_TRUE(reaches(goal, tip(0.0, 3.0, Eigen::Vector3d::UnitZ())));
  EXPECT_FALSE(reaches(goal, tip(0.0, 0.101, Eigen::Vector3d::UnitY())));
  goal.free_axis = 1;
  EXPECT_FALSE(reaches(goal, tip(0.0, 3.0, Eigen::Vector3d::UnitZ())));
}

/// Joints beyond the tip, or one that is held before it, change nothing of what is found.
TEST(GoalConfigurations, OfAnArmAreThoseOfItsJointsThatMoveTheTip) {
  Robot bare = load_robot("puma560");
  bare.inverse_kinematics = "numeric";
  bare.source.clear();
  Robot gripping = bare;
  gripping.joints.push_back({.name = "grip", .kind = JointKind::prismatic, .upper = 0.04});
  for (const char* finger : {"left", "right"})
    gripping.links.push_back({.name = finger, .parent = bare.tip_link, .joint = 6});
  Robot railed = bare;  // on a rail, which is held
  railed.joints.push_back({.name = "rail", .kind = JointKind::prismatic, .lower = -1.0, .upper = 1.0});
  const Robot held = [&] {
    Robot robot = railed;
    Link carriage{.name = "carriage", .parent = 0, .joint = 6};
    carriage.joint_name = "rail";
    for (Link& link : robot.links)
      if (link.parent >= 1) ++link.parent;
    robot.links[1].parent = 1;
    robot.links.insert(robot.links.begin() + 1, carriage);
    for (Body& body : robot.bodies) body.link += body.link >= 1;
    ++robot.tip_link;
    return with_held_joints(robot, {{"rail", 0.0, HoldSource::asked}}, "r.yaml");
  }();
  Random random(9);
  for (int round = 0; round < 5; ++round) {
    const Configuration near = random.configuration(bare);
    const Eigen::Isometry3d pose = tip_pose(bare, random.configuration(bare));
    const auto expected = goal_configurations(bare, pose, near);
    EXPECT_FALSE(expected.empty());
    Configuration more(7);
    more << near, 0.03;
    const auto with_hand = goal_configurations(gripping, pose, more),
               behind = goal_configurations(held, pose, near);
    EXPECT_GE(with_hand.size(), expected.size());
    EXPECT_EQ(behind.size(), expected.size());
    for (const Configuration& q : with_hand) EXPECT_EQ(q[6], 0.03) << "the hand stays";
    for (const Configuration& q : behind) EXPECT_TRUE(tip_pose(held, q).isApprox(pose, 1e-4));
    const auto far = inverse_kinematics(gripping, pose, more, {.restarts = 64});
    EXPECT_EQ(far ? (*far)[6] : 0.03, 0.03);
  }
}

TEST(GoalConfigurations, AnotherTipIsALinkOfTheRobotThatMoves) {
  const Robot robot = load_robot("panda");
  const Robot other = with_tip(robot, "link5");
  Random random(2);
  const Configuration q = random.configuration(robot);
  EXPECT_TRUE(tip_pose(other, q).isApprox(
      forward_kinematics(robot, q)[static_cast<std::size_t>(other.tip_link)], 1e-12));
  EXPECT_EQ(robot.links[static_cast<std::size_t>(other.tip_link)].name, "link5");
  EXPECT_THROW(with_tip(robot, "lnk5"), std::invalid_argument);
  EXPECT_THROW(with_tip(robot, "base"), std::invalid_argument);
}

/// By formulas of their own: the angle of the whole turn, or of the tilt of one axis.
double turn_left(const GoalPose& goal, const Eigen::Isometry3d& at) {
  const Eigen::Matrix3d& wanted = goal.map_from_tip.linear();
  const double whole =
      std::acos(std::clamp(((wanted.transpose() * at.linear()).trace() - 1.0) / 2.0, -1.0, 1.0));
  if (!goal.free_axis) return whole;
  return std::acos(std::clamp(wanted.col(*goal.free_axis).dot(at.linear().col(*goal.free_axis)), -1.0, 1.0));
}

/// Arms of two to seven joints; goals about poses that they reach, which themselves most of them do not.
TEST(GoalConfigurations, OfGoalsThatLeaveSomethingOpenKeepThem) {
  Random random(9);
  for (const char* name : {"planar2", "arm5", "arm6", "puma560", "panda"}) {
    const Robot robot = load_robot(name);
    int reached = 0, inside = 0, found_in_all = 0;
    constexpr int rounds = 24;
    for (int round = 0; round < rounds; ++round) {
      GoalPose goal{tip_pose(robot, random.configuration(robot))};
      if (round % 3 != 1) goal.free_axis = round % 3;
      if (round % 2 == 0) goal.turn_tolerance = 0.3;
      if (round % 4 > 1) goal.position_tolerance = 0.05;
      if (goal.free_axis)
        goal.map_from_tip.linear() *=
            Eigen::AngleAxisd(random.between(-3.0, 3.0), Eigen::Vector3d::Unit(*goal.free_axis)).matrix();
      const Configuration near = random.configuration(robot);
      const auto found = goal_configurations(robot, goal, near);
      reached += !found.empty();
      for (const Configuration& q : found) {
        ++found_in_all;
        EXPECT_EQ(limit_violation(robot, q), "");
        const Eigen::Isometry3d at = tip_pose(robot, q);
        const double away = (at.translation() - goal.map_from_tip.translation()).norm();
        EXPECT_LE(away, goal.position_tolerance + 1e-5) << name;
        EXPECT_LE(turn_left(goal, at), goal.turn_tolerance + 1e-5) << name << " " << round;
        EXPECT_TRUE(reaches(goal, at));
        inside += away > 0.01 || turn_left(goal, at) > 0.05;
      }
    }
    EXPECT_GE(reached, rounds - 1) << name;
    EXPECT_GT(inside, found_in_all / 10) << name;  // freedom is used
  }
}

TEST(GoalConfigurations, OfAPlanarArmWhoseTurnIsFreeAreBothItsElbows) {
  const Robot robot = load_robot("planar2");
  Random random(12);
  for (int round = 0; round < 20; ++round) {
    const double distance = random.between(0.6, 1.9), angle = random.between(-1.5, 1.5);
    GoalPose goal;
    goal.map_from_tip.translation() =
        Eigen::Vector3d(distance * std::cos(angle), distance * std::sin(angle), 0.0);
    goal.free_axis = 2;
    const double half = std::acos(distance / 2.0);  // of two links of a metre
    const auto found = goal_configurations(robot, goal, Eigen::Vector2d(angle, 0.5));
    ASSERT_EQ(found.size(), 2U) << distance;
    for (const Configuration& q : found) {
      EXPECT_NEAR(std::abs(q[1]), 2.0 * half, 1e-4);
      EXPECT_NEAR(q[0] + q[1] / 2.0, angle, 1e-4);
    }
  }
}

}  // namespace goal_configurations_test
}  // namespace clearway
