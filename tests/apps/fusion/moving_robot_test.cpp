// An arm that moves at 1 m/s and more, seen by a sensor whose clock, place and joints are off by what the
// setup states.

#include "apps/fusion/moving_robot.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "planning/robot/kinematics.hpp"
#include "planning/robot_files/load_robot.hpp"
#include "tests/datasets/complaint.hpp"
#include "tests/worlds/temporary_folder.hpp"

namespace clearway {
namespace moving_robot_test {

std::vector<std::string> names_of(const Robot& robot) {
  std::vector<std::string> names;
  for (const Joint& joint : robot.joints) names.push_back(joint.name);
  return names;
}

/// A smooth motion of all joints, some rad/s.
Configuration place_at(const Robot& robot, double time) {
  Configuration q(static_cast<Eigen::Index>(robot.dof()));
  for (Eigen::Index j = 0; j < q.size(); ++j) {
    const Joint& joint = robot.joints[static_cast<std::size_t>(j)];
    const double low = std::max(joint.lower, -2.0), high = std::min(joint.upper, 2.0);
    q[j] =
        0.5 * (low + high) +
        0.4 * (high - low) * std::sin((1.1 + 0.3 * static_cast<double>(j)) * time + static_cast<double>(j));
  }
  return q;
}

/// @param burst s, that readings come for of each half second
JointStream stream_of(const Robot& robot, double burst = 0.5) {
  JointStream stream;
  for (double time = 0.0; time < 6.0; time += 0.01) {
    if (std::fmod(time, 0.5) > burst) continue;
    const Configuration q = place_at(robot, time);
    stream.add(time, names_of(robot), {q.begin(), q.end()});
  }
  return stream;
}

/// The distance of a point from a body that is a sphere, capsule, cylinder or box; of hulls an upper bound,
/// to their corners.
double distance_to(const Body& body, const LinkPoses& poses, const Eigen::Vector3d& point) {
  const Eigen::Vector3d local =
      (poses[static_cast<std::size_t>(body.link)] * body.link_from_shape).inverse() * point;
  return body.shape.signed_distance(local);
}

/// Points on and in the covers of the bodies, which lie in them or just beside: those within the bodies are
/// kept.
std::vector<Eigen::Vector3d> points_of(const Robot& robot, const LinkPoses& poses, std::mt19937& random) {
  std::normal_distribution<double> normal;
  std::vector<Eigen::Vector3d> points;
  for (const Body& body : robot.bodies) {
    for (const Sphere& sphere : body.cover) {
      for (int i = 0; i < 30; ++i) {
        const Eigen::Vector3d way =
            Eigen::Vector3d(normal(random), normal(random), normal(random)).normalized();
        const Eigen::Vector3d point =
            poses[static_cast<std::size_t>(body.link)] * (sphere.center + sphere.radius * way);
        if (distance_to(body, poses, point) <= 0.0) points.push_back(point);
      }
    }
  }
  return points;
}

class MovingRobots : public ::testing::TestWithParam<const char*> {};

TEST_P(MovingRobots, LeaveNoneOfTheirPointsWhateverTheStatedErrors) {
  const Robot robot = load_robot(GetParam());
  RobotSetup setup;
  setup.name = GetParam();
  setup.self_margin = 0.0;
  setup.latency = 0.02;
  setup.joint_error = 0.5 * M_PI / 180.0;
  setup.place_error = 0.005;
  const MovingRobot moving(setup, stream_of(robot));
  std::mt19937 random(8);
  std::uniform_real_distribution<double> unit(-1.0, 1.0);
  std::size_t all = 0, taken = 0;
  for (int trial = 0; trial < 40; ++trial) {
    const double time = 0.2 + 0.14 * trial;
    Configuration q = place_at(robot, time + 0.019 * unit(random));
    for (double& joint : q) joint += setup.joint_error * unit(random);
    Eigen::Vector3d off(unit(random), unit(random), unit(random));
    off *= 0.0049 / off.norm();
    Scan scan;
    scan.time = time;
    scan.map_from_sensor = Eigen::Translation3d(1, 2, 3) * Eigen::AngleAxisd(0.7, Eigen::Vector3d::UnitX());
    for (const Eigen::Vector3d& point : points_of(robot, forward_kinematics(robot, q), random))
      scan.points.push_back((scan.map_from_sensor.inverse() * (point + off)).cast<float>());
    all += scan.points.size();
    const std::size_t own = moving.take_out(scan).points;
    EXPECT_EQ(scan.taken_out.size(), own);
    taken += own;
  }
  ASSERT_GT(all, 1000U);
  EXPECT_GE(taken, all - all / 1000);
}

TEST_P(MovingRobots, LeaveNoneOfTheirPointsWhileReadingsAreMissing) {
  const Robot robot = load_robot(GetParam());
  RobotSetup setup;
  setup.name = GetParam();
  setup.self_margin = setup.latency = setup.joint_error = setup.place_error = 0.0;
  const MovingRobot moving(setup, stream_of(robot, 0.045));
  std::mt19937 random(10);
  std::size_t left = 0;
  int known = 0;
  for (int trial = 0; trial < 40; ++trial) {
    Scan scan;
    scan.time = 0.2 + 0.13 * trial;
    for (const Eigen::Vector3d& point :
         points_of(robot, forward_kinematics(robot, place_at(robot, scan.time)), random))
      scan.points.push_back(point.cast<float>());
    const std::vector<Eigen::Vector3f> own = scan.points;
    const auto [taken, unknown] = moving.take_out(scan);
    if (!unknown.empty()) {
      EXPECT_EQ(scan.points.size(), own.size());
      EXPECT_NE(unknown.find("leave open by"), std::string::npos) << unknown;
      continue;
    }
    ++known;
    EXPECT_EQ(scan.taken_out.size(), taken);
    EXPECT_EQ(scan.points.size() + taken, own.size());
    left += scan.points.size();
  }
  EXPECT_GT(known, 3);
  EXPECT_LT(known, 40);
  EXPECT_LE(left, 20U);  // roundings, of bodies in their places
}

/// A scan in the course of which the robot is seen at other times, and these.
struct Sweep {
  Scan scan;
  std::vector<float> times;  ///< s after the scan's

  void add(const Robot& robot, double seen_at, double since, std::mt19937& random) {
    for (const Eigen::Vector3d& point :
         points_of(robot, forward_kinematics(robot, place_at(robot, seen_at)), random)) {
      scan.points.push_back(point.cast<float>());
      times.push_back(static_cast<float>(since));
    }
  }
};

/// A sensor that goes round in a tenth of a second, as lidars do: points of one scan show the robot at 50
/// times. All errors are stated as none.
TEST_P(MovingRobots, LeaveNoneOfTheirPointsOfASweep) {
  const Robot robot = load_robot(GetParam());
  RobotSetup setup;
  setup.name = GetParam();
  setup.self_margin = setup.latency = setup.joint_error = setup.place_error = 0.0;
  const MovingRobot moving(setup, stream_of(robot));
  std::mt19937 random(11);
  std::size_t all = 0, left = 0, left_at_once = 0;
  for (int trial = 0; trial < 5; ++trial) {
    Sweep sweep;
    auto& [scan, times] = sweep;
    scan.time = 0.2 + 0.9 * trial;
    for (int step = 49; step >= 0; --step) {  // in any order
      const double since = 0.002 * step - 0.03;
      sweep.add(robot, scan.time + since, since, random);
    }
    Scan at_once = scan;
    all += scan.points.size();
    EXPECT_EQ(moving.take_out(scan, times).unknown, "");
    moving.take_out(at_once);
    left += scan.points.size();
    left_at_once += at_once.points.size();
  }
  EXPECT_LE(left, all / 1000);
  EXPECT_GT(left_at_once, all / 100);
}

bool is_within(const Body& body, const LinkPoses& poses, const Eigen::Vector3d& point, double reach) {
  if (distance_to(body, poses, point) <= reach) return true;
  const Eigen::Isometry3d pose = poses[static_cast<std::size_t>(body.link)] * body.link_from_shape;
  const Eigen::Isometry3d at(Eigen::Translation3d{point});
  return distance(body.shape, pose, Shape::sphere(1e-9), at, reach).lower <= reach;
}

/// What stands where the robot was a moment before, or will be, stays.
TEST_P(MovingRobots, OfASweepTakeOutNothingBeyondTheGrowthAtEachTime) {
  const Robot robot = load_robot(GetParam());
  RobotSetup setup;
  setup.name = GetParam();
  setup.self_margin = setup.latency = setup.joint_error = setup.place_error = 0.0;
  const MovingRobot moving(setup, stream_of(robot));
  std::mt19937 random(12);
  Sweep sweep;
  auto& [scan, times] = sweep;
  scan.time = 2.0;
  for (int step = 0; step < 50; step += 7)
    sweep.add(robot, scan.time + 0.002 * (49 - step), 0.002 * step, random);
  const std::vector<Eigen::Vector3f> before = scan.points;
  ASSERT_EQ(moving.take_out(scan, times).unknown, "");
  std::size_t next = 0, beyond = 0;
  for (std::size_t i = 0; i < before.size(); ++i) {
    const double time = scan.time + static_cast<double>(times[i]);
    const LinkPoses poses = forward_kinematics(robot, place_at(robot, time));
    const std::vector<double> growths = moving.growths(time);
    bool is_near = false;
    for (std::size_t b = 0; b < robot.bodies.size(); ++b)
      is_near |= is_within(robot.bodies[b], poses, before[i].cast<double>(), growths[b] + 5e-3);
    beyond += is_near ? 0 : 1;
    if (next < scan.points.size() && scan.points[next] == before[i])
      ++next;
    else
      EXPECT_TRUE(is_near) << before[i].transpose();
  }
  EXPECT_EQ(next, scan.points.size());
  EXPECT_GT(beyond, 0U);
}

TEST_P(MovingRobots, TakeOutNothingBeyondTheStatedGrowth) {
  const Robot robot = load_robot(GetParam());
  RobotSetup setup;
  setup.name = GetParam();
  const MovingRobot moving(setup, stream_of(robot));
  std::mt19937 random(9);
  std::normal_distribution<double> normal(0.0, 0.4);
  std::size_t taken = 0;
  for (int trial = 0; trial < 20; ++trial) {
    Scan scan;
    scan.time = 0.2 + 0.25 * trial;
    const LinkPoses poses = forward_kinematics(robot, place_at(robot, scan.time));
    for (int i = 0; i < 2000; ++i) {
      const Body& body = robot.bodies[static_cast<std::size_t>(i) % robot.bodies.size()];
      const Eigen::Vector3d middle =
          (poses[static_cast<std::size_t>(body.link)] * body.link_from_shape).translation();
      scan.points.push_back(
          (middle + Eigen::Vector3d(normal(random), normal(random), normal(random))).cast<float>());
    }
    const std::vector<Eigen::Vector3f> before = scan.points;
    const std::vector<double> growths = moving.growths(scan.time);
    taken += moving.take_out(scan).points;
    std::size_t next = 0;
    for (const Eigen::Vector3f& point : before) {
      bool is_near = false;
      for (std::size_t b = 0; b < robot.bodies.size(); ++b)
        is_near |= distance_to(robot.bodies[b], poses, point.cast<double>()) <= growths[b] + 1e-3;
      if (next < scan.points.size() && scan.points[next] == point) {
        ++next;
        continue;
      }
      EXPECT_TRUE(is_near) << point.transpose();
    }
    EXPECT_EQ(next, scan.points.size());
  }
  EXPECT_GT(taken, 100U);
}

INSTANTIATE_TEST_SUITE_P(Shipped, MovingRobots, ::testing::Values("puma560", "panda", "arm5"));

/// By arithmetic, of a disc that slides along x at half a metre a second.
TEST(MovingRobot, GrowsByItsMarginAndByAllThatItsPlaceMayBeOff) {
  RobotSetup setup;
  setup.name = "point";
  setup.self_margin = 0.01, setup.place_error = 0.002, setup.joint_error = 0.003, setup.latency = 0.1;
  JointStream stream;
  for (int k = 0; k <= 100; ++k) stream.add(0.1 * k, {"x", "y"}, {0.05 * k, 0.0});
  const MovingRobot moving(setup, stream);
  for (const double growth : moving.growths(5.0))
    EXPECT_NEAR(growth, 0.01 + 0.002 + 2 * 0.003 + 0.5 * 0.1, 1e-9);
  for (const double error : moving.place_errors()) EXPECT_NEAR(error, 0.002 + 2 * 0.003, 1e-9);
}

/// Of an arm whose shoulder turns at 2 rad/s: each link turns by as much, and a point goes as far as its
/// distance from the shoulder has it.
TEST(MovingRobot, WhatALinkIsAskedOfMovesAndTurnsWithItsJoints) {
  RobotSetup setup;
  setup.name = "planar2";
  setup.latency = 0.01;
  const Robot robot = load_robot("planar2");
  JointStream stream;
  for (int k = 0; k <= 100; ++k) stream.add(0.01 * k, names_of(robot), {0.02 * k - 1.0, 0.7});
  const MovingRobot moving(setup, stream);
  const LinkPoses poses = *moving.poses(0.5);
  int turned = 0;
  for (int link = 0; link < static_cast<int>(robot.links.size()); ++link) {
    const Eigen::Vector3d in_link(0.1, 0.2, 0.3);
    const bool is_moved = link > 0;
    const auto [shift, turn] = moving.motion(0.5, link, in_link);
    const double away = (poses[static_cast<std::size_t>(link)] * in_link).head<2>().norm();
    EXPECT_NEAR(turn, is_moved ? 0.02 : 0.0, 1e-9) << link;
    EXPECT_NEAR(shift, is_moved ? 0.02 * away : 0.0, 1e-9) << link;
    turned += is_moved;
  }
  EXPECT_GE(turned, 2);
}

TEST(MovingRobot, LeavesAScanAloneAtATimeThatItsJointsDoNotCover) {
  const Robot robot = load_robot("arm5");
  RobotSetup setup;
  setup.name = "arm5";
  const MovingRobot moving(setup, stream_of(robot));
  Scan scan;
  scan.time = 7.0;
  scan.points = {{0, 0, 0.1F}};
  EXPECT_FALSE(moving.take_out(scan).unknown.empty());
  EXPECT_EQ(scan.points.size(), 1U);
  scan.time = 5.5;
  scan.points = {{9, 9, 9}};
  EXPECT_TRUE(moving.take_out(scan, {0.4F}).unknown.empty());
  EXPECT_NE(moving.take_out(scan, {1.5F}).unknown, "");  // a sweep that goes on when the readings have ended
}

TEST(MovingRobot, ReadingsInDegreesAreRefusedAndThoseBeyondALimitAreTold) {
  const Robot robot = load_robot("panda");
  RobotSetup setup;
  setup.name = "panda";
  const auto stream = [&](double factor, double offset) {
    JointStream joints;
    for (double time = 0.0; time < 6.0; time += 0.1) {
      Configuration q = factor * place_at(robot, time);
      q[1] += offset;
      joints.add(time, names_of(robot), {q.begin(), q.end()});
    }
    return joints;
  };
  EXPECT_TRUE(MovingRobot(setup, stream(1.0, 0.0)).doubts().empty());
  const std::string sentence = complaint([&] { MovingRobot(setup, stream(180.0 / M_PI, 0.0)); });
  EXPECT_NE(sentence.find("the recorded joint positions at "), std::string::npos) << sentence;
  EXPECT_NE(sentence.find("are these degrees?"), std::string::npos) << sentence;
  const double to_upper = robot.joints[1].upper + 0.5 - place_at(robot, 0.0)[1];
  const MovingRobot beyond(setup, stream(1.0, to_upper));
  ASSERT_EQ(beyond.doubts().size(), 1U);
  EXPECT_NE(beyond.doubts()[0].find("joint '" + robot.joints[1].name + "' reads "), std::string::npos);
}

/// A bit that flipped, or a driver before it found its zero.
TEST(MovingRobot, SingleReadingsThatCannotBeAreLeftOut) {
  const Robot robot = load_robot("arm6");
  RobotSetup setup;
  setup.name = "arm6";
  JointStream joints = stream_of(robot);
  joints.add(3.005, {robot.joints[2].name}, {1e9});
  const MovingRobot moving(setup, joints);
  ASSERT_EQ(moving.doubts().size(), 1U);
  EXPECT_NE(moving.doubts()[0].find("1 of " + std::to_string(joints.readings(robot.joints[2].name).size()) +
                                    " readings of joint '" + robot.joints[2].name +
                                    "' cannot be, the first at 3.005 s"),
            std::string::npos)
      << moving.doubts()[0];
  const auto poses = moving.poses(3.005);
  ASSERT_TRUE(poses);
  const LinkPoses expected = forward_kinematics(robot, place_at(robot, 3.005));
  EXPECT_LT((poses->back().translation() - expected.back().translation()).norm(), 1e-3);
}

TEST(MovingRobot, NamesAJointThatTheStreamDoesNotHave) {
  RobotSetup setup;
  setup.name = "arm5";
  JointStream stream;
  stream.add(0.0, {"elbow"}, {0.0});
  const std::string sentence = complaint([&] { const MovingRobot robot(setup, stream); });
  EXPECT_NE(sentence.find("have no joint 'yaw'"), std::string::npos) << sentence;
  EXPECT_NE(sentence.find("'elbow'"), std::string::npos) << sentence;
  EXPECT_NE(sentence.find("`joint_names: {yaw: NAME}` in `robot` of the setup"), std::string::npos)
      << sentence;
}

/// A recording that calls the joints of planar2 otherwise.
class RenamedJoints : public ::testing::Test {
 protected:
  RenamedJoints() {
    setup_.robot.emplace();
    setup_.robot->name = "planar2";
    setup_.robot->joint_file = folder_.write(
        "joints.csv", "time, arm_shoulder, arm_elbow, j3\n0, 0.1, 0.2, 0.3\n0.2, 0.1, 0.2, 0.3\n");
  }
  std::vector<double> read(const std::map<std::string, std::string>& names, const std::string& prefix) {
    setup_.robot->joint_names = names;
    setup_.robot->joint_prefix = prefix;
    const JointStream joints = *recorded_joints(setup_, "unused.mcap");
    const MovingRobot moving(*setup_.robot, joints);
    return *joints.at(names_of(moving.robot()), 0.1);
  }
  std::string complaint_of(const std::map<std::string, std::string>& names, const std::string& prefix) {
    return complaint([&] { read(names, prefix); });
  }

  TemporaryFolder folder_;
  clearway::Setup setup_;
};

TEST_F(RenamedJoints, AreReadUnderTheRobotsNames) {
  EXPECT_EQ(read({}, "arm_"), (std::vector<double>{0.1, 0.2}));
  EXPECT_EQ(read({{"elbow", "j3"}}, "arm_"), (std::vector<double>{0.1, 0.3}));
  EXPECT_EQ(read({{"shoulder", "arm_elbow"}, {"elbow", "arm_shoulder"}}, ""),
            (std::vector<double>{0.2, 0.1}));
}

TEST_F(RenamedJoints, OfNoSuchNameAreRefusedWithTheNearest) {
  EXPECT_EQ(
      complaint_of({}, ""),
      "the recorded joint positions have no joint 'shoulder' of robot 'planar2', but 'arm_elbow', "
      "'arm_shoulder', 'j3': expected `joint_prefix: arm_` in `robot` of the setup where 'arm_shoulder' is "
      "it");
  EXPECT_EQ(complaint_of({}, "am_"),
            "setup, robot, field 'joint_prefix': no name of a recorded joint begins with 'am_'; these are "
            "arm_elbow, arm_shoulder, j3");
  EXPECT_EQ(
      complaint_of({{"elbow", "arm_elbw"}}, ""),
      "setup, robot, field 'joint_names': the recorded joint positions have no joint 'arm_elbw', did you "
      "mean 'arm_elbow'?");
  EXPECT_EQ(complaint_of({{"elbw", "arm_elbow"}}, "arm_"),
            "setup, robot, field 'joint_names': robot 'planar2' has no joint 'elbw', did you mean 'elbow'?");
}

}  // namespace moving_robot_test
}  // namespace clearway
