// Readings of joints in other units than radians and metres are noticed, turns that encoders count are not;
// and robots are where their joints were read outside of their planning group, too.
#include "apps/fusion/joint_readings.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <tuple>

#include "apps/fusion/moving_robot.hpp"
#include "apps/fusion/scan_inserter.hpp"
#include "mapping/free_space_map.hpp"
#include "planning/robot/kinematics.hpp"
#include "tests/datasets/complaint.hpp"
#include "tests/worlds/temporary_folder.hpp"
#include "tests/worlds/urdf_robots.hpp"

namespace clearway {
namespace joint_readings_test {

Joint joint_of(JointKind kind, double lower, double upper) {
  Joint joint;
  joint.name = "elbow";
  joint.kind = kind;
  joint.lower = lower;
  joint.upper = upper;
  return joint;
}

std::string refusal(const Joint& joint, double value) {
  return complaint([&] { require_possible(joint, value, "readings"); });
}

TEST(JointReadings, DegreesAndMillimetresAreRefused) {
  const Joint elbow = joint_of(JointKind::revolute, -3.14, 3.14);
  EXPECT_EQ(
      refusal(elbow, -90.0),
      "readings: joint 'elbow' reads -90 rad, its limits are -3.14 and 3.14 rad: expected radians; are these "
      "degrees?");
  for (const double value : {0.0, 3.2, -3.2, 3.14 + 2.0 * M_PI, -3.14 - 2.0 * M_PI})
    EXPECT_EQ(refusal(elbow, value), "") << value;
  const Joint finger = joint_of(JointKind::prismatic, 0.0, 0.04);
  EXPECT_NE(refusal(finger, 40.0)
                .find("reads 40 m, its limits are 0 and 0.04 m: expected metres; are these millimetres?"),
            std::string::npos);
  EXPECT_EQ(refusal(finger, 0.041), "");
  EXPECT_EQ(refusal(joint_of(JointKind::prismatic, 0.9, 1.1), 0.2), "")
      << "a way that is narrowed for planning";
  constexpr double endless = std::numeric_limits<double>::infinity();
  EXPECT_EQ(refusal(joint_of(JointKind::revolute, -endless, endless), 500.0), "");
}

TEST(JointReadings, WhatIsBeyondLimitsIsToldWholeTurnsAside) {
  const Joint elbow = joint_of(JointKind::revolute, -1.0, 2.0);
  for (int turns = -1; turns <= 1; ++turns) {
    const double turn = 2.0 * M_PI * turns;
    for (const double value : {-1.0, -1.05, 0.5, 2.0, 2.05})
      EXPECT_FALSE(beyond_limits(elbow, value + turn)) << value << " " << turns;
    for (const double value : {-1.2, 2.2, 3.3})
      EXPECT_TRUE(beyond_limits(elbow, value + turn)) << value << " " << turns;
  }
  EXPECT_TRUE(beyond_limits(joint_of(JointKind::prismatic, 0.0, 0.04), 0.07));
  EXPECT_FALSE(beyond_limits(joint_of(JointKind::prismatic, 0.0, 0.04), 0.05));
  constexpr double endless = std::numeric_limits<double>::infinity();
  EXPECT_FALSE(beyond_limits(joint_of(JointKind::revolute, -endless, endless), 500.0));
}

using worlds::urdf_joint;
using worlds::urdf_limit;
using worlds::urdf_link;

/// A lift that carries an arm of two joints with two fingers, the second of which mimics the first, and
/// beside it a second arm; the planning group is the shoulder alone.
class RobotsAsRead : public ::testing::Test {
 protected:
  RobotsAsRead() {
    const std::string rod = "<capsule radius='0.03' length='0.3'/>", ball = "<sphere radius='0.02'/>";
    folder_.write(
        "duo.urdf",
        "<robot name='duo'><link name='base'/>" + urdf_link("mast", "0 0 0", ball) +
            urdf_link("upper", "0.2 0 0", rod) + urdf_link("lower", "0.2 0 0", rod) +
            urdf_link("left", "0 0 0", ball) + urdf_link("right", "0 0 0", ball) +
            urdf_link("other", "0.2 0 0", rod) +
            urdf_joint("lift", "prismatic", "base", "mast", "0 0 0", "0 0 1", urdf_limit(0, 1)) +
            urdf_joint("shoulder", "revolute", "mast", "upper", "0 0 0", "0 0 1", urdf_limit(-2, 2)) +
            urdf_joint("elbow", "revolute", "upper", "lower", "0.4 0 0", "0 0 1", urdf_limit(-2, 2)) +
            urdf_joint("grip", "prismatic", "lower", "left", "0.4 0 0", "0 1 0", urdf_limit(0, 0.1)) +
            urdf_joint("follow", "prismatic", "lower", "right", "0.4 0 0", "0 -1 0",
                       urdf_limit(0, 0.1) + "<mimic joint='grip'/>") +
            urdf_joint("second", "revolute", "base", "other", "0 1 0", "0 0 1", urdf_limit(-2, 2)) +
            "</robot>");
    folder_.write("duo.srdf", "<robot name='duo'><group name='one'><joint name='shoulder'/></group></robot>");
    settings("");
  }

  void settings(const std::string& more) {
    setup_.name = folder_.write("group.yaml", "urdf: duo.urdf\nsrdf: duo.srdf\ngroup: one\n" + more);
    folder_.write("whole.yaml", "urdf: duo.urdf\n" + more);
  }

  static double position(const std::string& joint, double time) {
    return (joint == "grip" ? 0.05 : 0.4) + (joint == "grip" ? 0.02 : 0.3) * std::sin(time);
  }

  JointStream stream(const std::vector<std::string>& names) const {
    JointStream joints;
    for (double time = 0.0; time < 4.0; time += 0.02)
      for (const std::string& name : names) joints.add(time, {name}, {position(name, time)});
    return joints;
  }

  static std::size_t body_of(const Robot& robot, const std::string& part) {
    const auto found = std::find_if(robot.bodies.begin(), robot.bodies.end(),
                                    [&](const Body& body) { return body.part == part; });
    return static_cast<std::size_t>(found - robot.bodies.begin());
  }

  TemporaryFolder folder_;
  RobotSetup setup_;
  const std::vector<std::string> all_ = {"lift", "shoulder", "elbow", "grip", "second"};
};

/// Whatever is held in planning: before the group, beyond it, of the other arm, that which slides or mimics.
TEST_F(RobotsAsRead, AreWhereTheStreamSaysOutsideOfTheirGroupToo) {
  const MovingRobot moving(setup_, stream(all_));
  EXPECT_TRUE(moving.doubts().empty());
  const Robot whole = load_robot(folder_.file("whole.yaml"));
  const double time = 1.234;
  Configuration q(static_cast<Eigen::Index>(whole.dof()));
  for (std::size_t j = 0; j < whole.dof(); ++j)
    q[static_cast<Eigen::Index>(j)] = position(whole.joints[j].name, time);
  const LinkPoses expected = forward_kinematics(whole, q), poses = *moving.poses(time);
  ASSERT_EQ(poses.size(), expected.size());
  for (std::size_t i = 0; i < poses.size(); ++i)
    EXPECT_TRUE(poses[i].isApprox(expected[i], 1e-4)) << whole.links[i].name;
  Scan scan;
  scan.time = time;
  for (std::size_t i = 1; i < poses.size(); ++i)  // of each link its body's middle
    for (const Body& body : whole.bodies)
      if (body.link == static_cast<int>(i))
        scan.points.push_back((expected[i] * body.link_from_shape).translation().cast<float>());
  const std::size_t points = scan.points.size();
  EXPECT_EQ(moving.take_out(scan).points, points);
}

TEST_F(RobotsAsRead, GrowByWhatTheJointsOutsideOfTheirGroupLeaveOpen) {
  const MovingRobot alone(setup_, stream({"shoulder"})), moving(setup_, stream(all_));
  const std::size_t lower = body_of(moving.robot(), "lower"), mast = body_of(moving.robot(), "mast");
  EXPECT_GT(moving.growths(1.0)[lower], alone.growths(1.0)[lower] + 0.4 * setup_.joint_error);
  EXPECT_NEAR(alone.place_errors()[mast], setup_.place_error, 1e-12);
  EXPECT_NEAR(moving.place_errors()[mast], setup_.place_error + setup_.joint_error, 1e-12);
}

TEST_F(RobotsAsRead, KeepTheTipOfTheirGroup) {
  const auto [robot, held_at, doubts] = robot_as_read(setup_, stream(all_));
  EXPECT_EQ(robot.links[static_cast<std::size_t>(robot.tip_link)].name, "upper");
  EXPECT_EQ(robot.dof(), all_.size());
}

TEST_F(RobotsAsRead, TellWhichJointsStayHeldAsTheStreamLacksThem) {
  const auto [robot, held_at, doubts] = robot_as_read(setup_, stream({"shoulder", "elbow"}));
  EXPECT_EQ(robot.dof(), 2U);
  ASSERT_EQ(doubts.size(), 1U);
  EXPECT_NE(doubts[0].find("the recorded positions lack grip, lift, second:"), std::string::npos)
      << doubts[0];
  settings("fixed: {grip: 0.01, lift: 0.5, second: 0}\n");  // somebody said where they stand
  EXPECT_TRUE(robot_as_read(setup_, stream({"shoulder", "elbow"})).doubts.empty());
  EXPECT_EQ(robot_as_read(setup_, stream({"shoulder", "elbow", "lift"})).robot.dof(), 3U);
}

TEST_F(RobotsAsRead, HoldWhatIsInOtherUnitsOrReadNowAndThenAndSayWhy) {
  JointStream joints = stream({"shoulder", "elbow", "lift"});
  for (int k = 0; k < 50; ++k) joints.add(0.08 * k, {"grip"}, {255.0});  // steps of a driver
  for (int k = 0; k < 5; ++k) joints.add(1.0 * k, {"second"}, {0.3});
  const auto [robot, held_at, doubts] = robot_as_read(setup_, joints);
  EXPECT_EQ(robot.dof(), 3U);
  ASSERT_EQ(doubts.size(), 2U);
  EXPECT_EQ(doubts[0], "joint 'grip' is held at 0: its recorded positions cannot be (255 at 0 s)");
  EXPECT_EQ(doubts[1], "joint 'second' is held at 0: it was read too rarely for more than half of the time");
  const std::string sentence = complaint([&] { robot_as_read(setup_, stream({"elbow"})); });
  EXPECT_NE(sentence.find("have no joint 'shoulder'"), std::string::npos) << sentence;
}

TEST_F(RobotsAsRead, StandWhereTheyAreHeldWhileAJointOutsideOfTheirGroupIsNotKnown) {
  settings("fixed: {grip: 0.02}\n");
  JointStream joints = stream({"lift", "shoulder", "elbow", "second"});
  for (double time = 1.5; time < 4.0; time += 0.02) joints.add(time, {"grip"}, {0.05});
  const MovingRobot moving(setup_, joints);
  ASSERT_EQ(moving.doubts().size(), 1U);
  EXPECT_NE(moving.doubts()[0].find("joint 'grip' is held at 0.02 for 3"), std::string::npos)
      << moving.doubts()[0];
  const Body& finger = moving.robot().bodies[body_of(moving.robot(), "left")];
  const auto place_at = [&](double time, double grip) {  // of the finger, by hand
    const double lift = position("lift", time), turn = position("shoulder", time),
                 bend = position("elbow", time);
    return Eigen::Isometry3d(
        Eigen::Translation3d(0, 0, lift) * Eigen::AngleAxisd(turn, Eigen::Vector3d::UnitZ()) *
        Eigen::Translation3d(0.4, 0, 0) * Eigen::AngleAxisd(bend, Eigen::Vector3d::UnitZ()) *
        Eigen::Translation3d(0.4, grip, 0));
  };
  for (const auto& [time, grip, is_known] : {std::tuple{0.7, 0.02, false}, std::tuple{2.0, 0.05, true}}) {
    const Eigen::Isometry3d expected = place_at(time, grip);
    const Eigen::Isometry3d& pose = moving.poses(time)->at(static_cast<std::size_t>(finger.link));
    EXPECT_TRUE(pose.isApprox(expected, 1e-4)) << time;
    EXPECT_EQ(moving.knows(time, finger.link), is_known) << "a camera there would have a place or none";
    EXPECT_TRUE(moving.knows(time, moving.robot().tip_link));
    Scan scan;
    scan.time = time;
    scan.points = {expected.translation().cast<float>(), {3, 3, 3}};
    const MovingRobot::TakenOut taken = moving.take_out(scan);
    EXPECT_EQ(taken.unknown, "") << time;
    EXPECT_EQ(taken.points, 1U) << time;
  }
  EXPECT_FALSE(moving.poses(-1.0)) << "the group is not known";
  Scan early;
  early.time = -1.0;
  EXPECT_NE(moving.take_out(early).unknown.find("joint 'shoulder'"), std::string::npos);
}

TEST_F(RobotsAsRead, GiveASensorNoPlaceWhileAJointThatMovesItIsNotKnown) {
  JointStream joints = stream({"lift", "shoulder", "elbow"});
  for (double time = 1.5; time < 4.0; time += 0.02) joints.add(time, {"grip"}, {0.05});
  clearway::Setup setup;
  setup.robot = setup_;
  setup.sensors.resize(1);
  setup.sensors[0].name = "eye";
  setup.sensors[0].link = "left";
  const MovingRobot moving(setup_, joints);
  const BoardPoses boards(setup);
  MapOptions options;
  options.resolution = 0.1;
  FreeSpaceMap map(options);
  FusionCounts counts;
  ScanInserter inserter(setup, map, counts, boards, &moving);
  for (const double time : {0.5, 0.7, 2.0}) {
    CloudFrame cloud;
    cloud.points = {{2, 0, 0}};
    inserter.take({time, "eye", cloud}, cloud);
  }
  inserter.finish();
  EXPECT_EQ(counts.scans_without_pose, 2U);
  EXPECT_EQ(counts.scans_inserted, 1U);
}

/// A gripper that publishes for itself is no reason not to paint with the arm; a part that it moves is
/// painted where it was read as well.
TEST_F(RobotsAsRead, HavePartsPaintWhenTheJointsThatMoveThemWereRead) {
  JointStream joints = stream({"shoulder", "lift", "elbow", "second"});
  for (int k = 0; k < 40; ++k) joints.add(0.1 * k + 0.005, {"grip"}, {0.05});
  const MovingRobot moving(setup_, joints);
  const std::size_t lower = body_of(moving.robot(), "lower"), left = body_of(moving.robot(), "left");
  EXPECT_EQ(moving.times({lower}), joints.times({"shoulder"}));
  EXPECT_TRUE(moving.times({lower, left}).empty());
}

}  // namespace joint_readings_test
}  // namespace clearway
