#include "planning/robot/held_joints.hpp"

#include <gtest/gtest.h>

#include "planning/check/path_check.hpp"
#include "planning/robot/reach.hpp"
#include "planning/space/configuration_space.hpp"
#include "tests/worlds/random_world.hpp"
#include "tests/worlds/urdf_robots.hpp"

namespace clearway {
namespace held_joints_test {

using worlds::UrdfRobot;

/// Some joints held at random values, and the whole robot's configuration with these.
struct Halves {
  Robot held;
  Configuration q, whole;
};

Halves split(const Robot& robot, Random& random) {
  Halves halves;
  halves.whole = random.configuration(robot);
  std::vector<HeldJoint> joints;
  std::vector<double> moving;
  const int moves = random.below(static_cast<int>(robot.dof()));
  for (int j = 0; j < static_cast<int>(robot.dof()); ++j) {
    if (j == moves || random.below(2) == 0)
      moving.push_back(halves.whole[j]);
    else
      joints.push_back({robot.joints[static_cast<std::size_t>(j)].name, halves.whole[j], HoldSource::asked});
  }
  halves.q = Eigen::Map<Configuration>(moving.data(), static_cast<Eigen::Index>(moving.size()));
  halves.held = with_held_joints(robot, joints, "r.yaml");
  return halves;
}

TEST(HeldJoints, EveryLinkIsWhereTheWholeRobotHasItWithTheSameValues) {
  const UrdfRobot whip = worlds::whip(), telescope = worlds::telescope(), scissors = worlds::scissors(),
                  rack = worlds::rack_and_pinion();
  Random random(1);
  for (const Robot& robot : {telescope.robot(), rack.robot(), scissors.robot(), whip.robot(),
                             load_robot("panda"), load_robot("puma560")}) {
    for (int round = 0; round < 20; ++round) {
      const Halves halves = split(robot, random);
      const LinkPoses whole = forward_kinematics(robot, halves.whole);
      const LinkPoses part = forward_kinematics(halves.held, halves.q);
      for (std::size_t i = 0; i < whole.size(); ++i)
        EXPECT_TRUE(whole[i].isApprox(part[i], 1e-12)) << robot.name << " " << robot.links[i].name;
    }
  }
}

TEST(HeldJoints, TheCheckReadsThemFromTheFileAtEveryScale) {
  const UrdfRobot telescope = worlds::telescope(), scissors = worlds::scissors(),
                  rack = worlds::rack_and_pinion();
  Random random(2);
  for (const Robot& robot : {telescope.robot(), scissors.robot(), rack.robot()}) {
    for (const double scale : {1.0, 0.1, 3.0}) {
      const Halves halves = split(robot, random);
      Robot held = scaled(halves.held, scale);
      Configuration q = Configuration::Zero(static_cast<Eigen::Index>(held.dof()));
      for (std::size_t j = 0; j < held.dof(); ++j)
        q[static_cast<Eigen::Index>(j)] = 0.5 * (held.joints[j].lower + held.joints[j].upper);
      const std::string said = check_path(held, Snapshot(), {}, 0.0, {q}).first_contact;
      EXPECT_EQ(said.find("is not what its file"), std::string::npos) << said;
      if (held.held.empty()) continue;
      held.held.front().value += held.held.front().value > 0.0 ? -1e-6 : 1e-6;  // now it lies
      const std::string lie = check_path(held, Snapshot(), {}, 0.0, {q}).first_contact;
      EXPECT_NE(lie.find("away from where kdl_parser puts it"), std::string::npos) << lie;
      held.held.clear();
      const std::string silence = check_path(held, Snapshot(), {}, 0.0, {q}).first_contact;
      EXPECT_NE(silence.find("is none of the robot's"), std::string::npos) << silence;
    }
  }
}

/// Only the left arm moves; a voxel where the right one stands blocks all of its configurations.
TEST(HeldJoints, ABodyThatStandsStillAtAHeldJointIsPolicedByPlannersAndCheck) {
  const UrdfRobot scissors = worlds::scissors();
  const Robot held = with_held_joints(scissors.robot(), {{"right_turn", -1.0, HoldSource::asked}}, "s.yaml");
  EXPECT_FALSE(is_moved(held, held.bodies[1].link));
  EXPECT_TRUE(is_policed(held, held.bodies[1].link));
  const Eigen::Vector3d inside = forward_kinematics(held, Eigen::VectorXd::Zero(1))[2] *
                                 Eigen::Vector3d(held.bodies[1].link_from_shape.translation());
  for (const bool is_blocked : {false, true}) {
    FreeSpaceMap map({.resolution = 0.05});
    Scan scan;
    scan.map_from_sensor.translation() = Eigen::Vector3d(0.0, -3.0, 2.0);
    const Eigen::Vector3d hit = is_blocked ? inside : Eigen::Vector3d(3.0, 3.0, 0.0);
    scan.points = {(hit - scan.map_from_sensor.translation()).cast<float>()};
    map.insert(scan);
    Policies policies;
    policies.critical_by_default = false;
    policies.other = Policy::not_occupied;
    const Snapshot snapshot = map.snapshot();
    const ConfigurationSpace space(held, snapshot, policies);
    const Configuration q = Eigen::VectorXd::Constant(1, 0.3), far = Eigen::VectorXd::Constant(1, 1.0);
    EXPECT_EQ(space.is_free(q), !is_blocked);
    EXPECT_EQ(space.is_edge_free(q, far), !is_blocked);
    EXPECT_EQ(check_path(held, snapshot, space.policies(), 0.0, {q, far}).valid, !is_blocked);
  }
}

TEST(HeldJoints, TwoBodiesThatAreHeldAgainstEachOtherTouchInPlannersAndCheck) {
  const std::string ball =
      "<collision><origin xyz='0.3 0 0'/><geometry><sphere radius='0.1'/></geometry></collision>";
  const auto arm = [&](const std::string& name, const std::string& y) {
    return "<link name='" + name + "'>" + ball + "</link><joint name='" + name +
           "_turn' type='revolute'><parent link='base'/><child link='" + name + "'/><origin xyz='0 " + y +
           " 0'/><axis xyz='0 0 1'/><limit lower='-2' upper='2' velocity='1' effort='1'/></joint>";
  };
  const UrdfRobot arms("r", "<link name='base'/>" + arm("left", "2") + arm("a", "0") + arm("b", "0.3"));
  const Configuration q = Configuration::Zero(1);
  for (const bool touch : {true, false}) {
    const double turn = touch ? 0.6 : -0.6;
    const Robot held = with_held_joints(
        arms.robot(), {{"a_turn", turn, HoldSource::asked}, {"b_turn", -turn, HoldSource::zero}}, "r.urdf");
    ASSERT_EQ(held.dof(), 1u);
    EXPECT_EQ(ConfigurationSpace(held, Snapshot(), {}, {}).is_free(q), !touch);
    const PathVerdict verdict = check_path(held, Snapshot(), {}, 0.0, {q, q});
    EXPECT_EQ(verdict.valid, !touch) << verdict.first_contact;
    EXPECT_EQ(verdict.first_contact.find("a touches b") != std::string::npos, touch) << verdict.first_contact;
  }
}

TEST(HeldJoints, WhatCannotBeHeldIsRefusedInOneSentence) {
  const UrdfRobot telescope = worlds::telescope();
  const auto refusal = [&](const std::vector<HeldJoint>& joints) -> std::string {
    try {
      with_held_joints(telescope.robot(), joints, "t.yaml");
    } catch (const std::invalid_argument& error) {
      return error.what();
    }
    return "accepted";
  };
  EXPECT_EQ(refusal({{"turn", 0.0, HoldSource::asked}}), "accepted");
  EXPECT_EQ(refusal({{"turm", 0.0, HoldSource::asked}}),
            "--fix: joint 'turm' cannot be fixed, because no joint of that name moves, did you mean 'turn'?");
  EXPECT_EQ(refusal({{"side", 0.0, HoldSource::settings}}),
            "t.yaml: joint 'side' cannot be fixed, because it follows 'reach' (mimic), expected that one");
  EXPECT_EQ(refusal({{"turn", 3.5, HoldSource::asked}}),
            "--fix: joint 'turn' is fixed at 3.5, expected a number within its limits -3 to 3");
  EXPECT_EQ(
      refusal({{"turn", 90.0, HoldSource::asked}}),
      "--fix: joint 'turn' is fixed at 90, expected a number within its limits -3 to 3 (radians; in degrees "
      "it would be within them: 1.5708)");
  EXPECT_EQ(refusal({{"turn", 0.0, HoldSource::asked}, {"reach", 0.0, HoldSource::asked}}),
            "--fix: every joint is fixed, expected at least one that moves (--group)");
  EXPECT_EQ(refusal({{"turn", 0.0, HoldSource::settings}, {"reach", 0.0, HoldSource::settings}}),
            "t.yaml: every joint is fixed, expected at least one that moves (--group)");
}

}  // namespace held_joints_test
}  // namespace clearway
