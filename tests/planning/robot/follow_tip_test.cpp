#include "planning/robot/follow_tip.hpp"

#include <gtest/gtest.h>

#include "planning/robot/puma_branches.hpp"
#include "planning/robot_files/load_robot.hpp"
#include "tests/worlds/random_world.hpp"

namespace clearway {
namespace follow_tip_test {

/// A configuration well inside of the limits.
Configuration inner(const Robot& robot, Random& random) {
  Configuration q = random.configuration(robot);
  for (std::size_t j = 0; j < robot.dof(); ++j) {
    const Joint& joint = robot.joints[j];
    if (!std::isfinite(joint.upper - joint.lower)) continue;
    const double middle = 0.5 * (joint.lower + joint.upper);
    q[static_cast<Eigen::Index>(j)] = middle + 0.6 * (q[static_cast<Eigen::Index>(j)] - middle);
  }
  return q;
}

TEST(FollowTip, ATipLedAlongAWayOfTheRobotsOwnIsThereAtEachStep) {
  Random random(11);
  for (const char* name : {"panda", "puma560", "arm6"}) {
    const Robot robot = load_robot(name);
    int steps = 0, reached = 0;
    for (int round = 0; round < 5; ++round) {
      const Configuration from = inner(robot, random), to = inner(robot, random);
      Configuration q = from;
      for (int step = 1; step <= 40; ++step) {
        const Eigen::Isometry3d pose = tip_pose(robot, from + (to - from) * (step / 40.0));
        const FollowedTip followed = follow_tip(robot, pose, q);
        ++steps;
        EXPECT_EQ(followed.is_reached, followed.reason.empty()) << name;
        EXPECT_EQ(limit_violation(robot, followed.q), "") << name;
        if (followed.is_reached) {
          ++reached;
          const Eigen::Isometry3d off = tip_pose(robot, followed.q).inverse() * pose;
          EXPECT_LT(off.translation().norm(), 1e-5) << name;
          EXPECT_LT((off.linear() - Eigen::Matrix3d::Identity()).norm(), 1e-5) << name;
        }
        q = followed.q;
      }
    }
    EXPECT_GE(reached, steps * 3 / 4) << name;  // a kept arm configuration cannot follow every way
  }
}

TEST(FollowTip, APumaKeepsShoulderElbowAndWrist) {
  const Robot robot = load_robot("puma560");
  Random random(12);
  int reached = 0;
  for (int round = 0; round < 200; ++round) {
    const Configuration from = inner(robot, random);
    const FollowedTip followed = follow_tip(robot, tip_pose(robot, inner(robot, random)), from);
    if (!followed.is_reached) {
      EXPECT_EQ(followed.q, from);
      continue;
    }
    ++reached;
    EXPECT_EQ(puma_branch_of(robot, followed.q), puma_branch_of(robot, from));
  }
  EXPECT_GT(reached, 20);
}

TEST(FollowTip, BeyondTheWorkspaceTheRobotStaysFeasibleAndSaysWhy) {
  for (const char* name : {"panda", "puma560", "arm6"}) {
    const Robot robot = load_robot(name);
    Random random(13);
    Configuration q = inner(robot, random);
    Eigen::Isometry3d pose = tip_pose(robot, q);
    bool left = false;
    for (int step = 0; step < 60; ++step) {
      pose.translation().x() += 0.05;
      const FollowedTip followed = follow_tip(robot, pose, q);
      EXPECT_EQ(limit_violation(robot, followed.q), "") << name;
      EXPECT_FALSE(left && followed.is_reached && step > 50) << name;
      const bool says_why = followed.reason.find("reach") != std::string::npos ||
                            followed.reason.find("limit") != std::string::npos;
      EXPECT_EQ(says_why, !followed.is_reached) << followed.reason;
      left = left || !followed.is_reached;
      q = followed.q;
    }
    EXPECT_TRUE(left) << name;
    // Back where it can be, it follows again.
    pose = tip_pose(robot, q);
    EXPECT_TRUE(follow_tip(robot, pose, q).is_reached) << name;
  }
}

TEST(FollowTip, TheReasonNamesTheJointAtItsLimit) {
  Robot robot = load_robot("arm6");
  Random random(14);
  const Configuration q = inner(robot, random);
  Configuration beyond = q;
  beyond[0] += 0.2;
  const Eigen::Isometry3d pose = tip_pose(robot, beyond);
  robot.joints[0].upper = q[0] + 0.1;
  const FollowedTip followed = follow_tip(robot, pose, q);
  EXPECT_FALSE(followed.is_reached);
  EXPECT_NE(followed.reason.find("joint '" + robot.joints[0].name + "' is at its limit"), std::string::npos)
      << followed.reason;
}

}  // namespace follow_tip_test
}  // namespace clearway
