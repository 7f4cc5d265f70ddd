#include "planning/robot/follow_tip.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <numbers>
#include <optional>

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

/// A hand that wanders about `home`: at most 20 mm and 0.1 rad per frame, so that joints may move by 0.5 rad.
class Hand {
 public:
  Hand(const Eigen::Isometry3d& home, double scale) : pose_(home), home_(home), scale_(scale) {}

  Eigen::Isometry3d moved(Random& random) {
    velocity_ =
        0.9 * velocity_ + random.point(0.003) - 0.02 * (pose_.translation() - home_.translation()) / scale_;
    turning_ = 0.9 * turning_ + random.point(0.02);
    pose_.translation() += scale_ * std::min(1.0, 0.02 / velocity_.norm()) * velocity_;
    const double turn = std::min(0.1, turning_.norm());
    pose_.linear() = Eigen::AngleAxisd(turn, turning_.normalized()).toRotationMatrix() * pose_.linear();
    return pose_;
  }

 private:
  Eigen::Isometry3d pose_, home_;
  double scale_;
  Eigen::Vector3d velocity_ = Eigen::Vector3d::Zero(), turning_ = Eigen::Vector3d::Zero();
};

TEST(FollowTip, NoJointMovesFartherThanTheTipsWayExplains) {
  Random random(15);
  for (const char* name : {"panda", "arm6", "puma560", "puma560_miniature", "arm5"}) {
    const Robot robot = load_robot(name);
    int led_on = 0;
    for (int round = 0; round < 6; ++round) {
      Configuration q = inner(robot, random);
      Hand hand(tip_pose(robot, q), robot.scale);
      bool was_there = true;
      for (int frame = 0; frame < 100; ++frame) {
        const Eigen::Isometry3d begin = tip_pose(robot, q), pose = hand.moved(random);
        const FollowedTip followed = follow_tip(robot, pose, q);
        const double move = (followed.q - q).lpNorm<Eigen::Infinity>();
        EXPECT_LE(move, largest_joint_move(robot, begin, pose) + 1e-9) << name;
        EXPECT_TRUE(!was_there || move <= 0.5 + 1e-9) << name << ": " << move;
        led_on += followed.is_reached;
        was_there = followed.is_reached;
        q = followed.q;
      }
    }
    EXPECT_GE(led_on, 6 * 100 / 3) << name;
  }
}

TEST(FollowTip, ALongWayLetsJointsMoveFarther) {
  const Robot robot = load_robot("puma560"), small = load_robot("puma560_miniature"),
              flat = load_robot("planar2");
  const Eigen::Isometry3d begin = Eigen::Isometry3d::Identity();
  const Eigen::Isometry3d moved(Eigen::Translation3d(0.0, 0.08, 0.0));
  const Eigen::Isometry3d turned(Eigen::AngleAxisd(0.3, Eigen::Vector3d::UnitX()));
  EXPECT_DOUBLE_EQ(largest_joint_move(robot, begin, begin), 0.5);
  EXPECT_NEAR(largest_joint_move(robot, begin, moved), 2.0, 1e-12);
  EXPECT_NEAR(largest_joint_move(small, begin, moved), 2.0 / small.scale, 1e-12);
  EXPECT_NEAR(largest_joint_move(robot, begin, turned), 1.5, 1e-12);
  EXPECT_DOUBLE_EQ(largest_joint_move(flat, begin, turned), 0.5);  // follows the tip's place alone
}

/// Shoulder, elbow and wrist of arm6, whose joints 2 to 4 are parallel: the factors of its Jacobian's
/// determinant.
std::array<bool, 3> sides_of_arm6(const Configuration& q) {
  const double upper = -0.425 * std::cos(q[1]), fore = -0.39225 * std::cos(q[1] + q[2]);
  const double wrist = 0.09465 * std::sin(q[1] + q[2] + q[3]);
  return {upper + fore + wrist > 0.0, std::sin(q[2]) > 0.0, std::sin(q[4]) > 0.0};
}

TEST(FollowTip, AnArmWithoutAClosedFormKeepsShoulderElbowAndWrist) {
  const Robot arm6 = load_robot("arm6");
  Robot puma = load_robot("puma560");
  puma.inverse_kinematics = "numeric";
  Random random(16);
  for (int round = 0; round < 10; ++round) {
    Configuration q = inner(arm6, random), p = inner(puma, random);
    const auto sides = sides_of_arm6(q);
    const std::size_t branch = puma_branch_of(puma, p);
    Hand hand(tip_pose(arm6, q), 3.0),
        other(tip_pose(puma, p), 3.0);  // fast: out of reach, and back elsewhere
    for (int frame = 0; frame < 100; ++frame) {
      q = follow_tip(arm6, hand.moved(random), q).q;
      EXPECT_EQ(sides_of_arm6(q), sides) << "round " << round << ", frame " << frame << ": " << q.transpose();
      p = follow_tip(puma, other.moved(random), p).q;
      EXPECT_EQ(puma_branch_of(puma, p), branch) << "round " << round << ", frame " << frame;
    }
  }
}

/// Where a thousand small steps of damped least squares lead from `q`; none where the tip leaves the straight
/// way to `end`, or a joint its limits.
std::optional<Configuration> led_slowly(const Robot& robot, Configuration q, const Eigen::Isometry3d& end) {
  const Eigen::Isometry3d begin = tip_pose(robot, q);
  const Eigen::Quaterniond from(begin.linear()), to(end.linear());
  constexpr int steps = 1000;
  for (int step = 1; step <= steps + 5; ++step) {
    const double part = std::min(1.0, 1.0 * step / steps);
    const Eigen::Isometry3d is = tip_pose(robot, q);
    const Eigen::AngleAxisd turn(from.slerp(part, to).toRotationMatrix() * is.linear().transpose());
    Eigen::Matrix<double, 6, 1> error;
    error << (1.0 - part) * begin.translation() + part * end.translation() - is.translation(),
        turn.angle() * turn.axis();
    if (error.norm() > 1e-3) return std::nullopt;
    const Eigen::MatrixXd j = jacobian(robot, forward_kinematics(robot, q), robot.tip_link, is.translation());
    const Eigen::MatrixXd damped = j * j.transpose() + 1e-10 * Eigen::MatrixXd::Identity(6, 6);
    q += j.transpose() * damped.ldlt().solve(error);
    if (!limit_violation(robot, q).empty()) return std::nullopt;
  }
  return q;
}

TEST(FollowTip, TheTipFollowsWhereverJointsThatMoveSteadilyTakeIt) {
  Random random(17);
  for (const char* name : {"arm6", "panda", "puma560"}) {
    const Robot robot = load_robot(name);
    int led = 0;
    for (int round = 0; round < 60; ++round) {
      Configuration from = inner(robot, random);
      if (round % 2 == 0)
        from[4] = random.between(-0.1, 0.1);  // a wrist that is nearly singular, of two of them
      Hand hand(tip_pose(robot, from), robot.scale);
      Eigen::Isometry3d pose = hand.moved(random);
      for (int frame = 0; frame < 10; ++frame) pose = hand.moved(random);
      const auto slowly = led_slowly(robot, from, pose);
      const double most = 0.9 * largest_joint_move(robot, tip_pose(robot, from), pose);
      if (!slowly || (*slowly - from).lpNorm<Eigen::Infinity>() > most) continue;
      if (robot.dof() == 6 && (*slowly)[4] * from[4] <= 0.0) continue;  // through the singular configuration
      ++led;
      const FollowedTip followed = follow_tip(robot, pose, from);
      EXPECT_TRUE(followed.is_reached) << name << ", round " << round << ": " << followed.reason;
      EXPECT_TRUE(robot.dof() > 6 || (followed.q - *slowly).norm() < 1e-3) << name << ", round " << round;
    }
    EXPECT_GE(led, 20) << name;
  }
}

TEST(FollowTip, APlanarArmThatIsLedBeyondItsReachAndBackKeepsItsElbow) {
  const Robot robot = load_robot("planar2");
  Random random(18);
  int reached = 0;
  for (int round = 0; round < 40; ++round) {
    Configuration q = inner(robot, random);
    const bool side = q[1] > 0.0;
    const Eigen::Isometry3d home = tip_pose(robot, q);
    Hand hand(home, 3.0);
    for (int frame = 0; frame < 100; ++frame) {
      Eigen::Isometry3d pose = hand.moved(random);
      pose.translation().z() = home.translation().z();
      const FollowedTip followed = follow_tip(robot, pose, q);
      q = followed.q;
      EXPECT_EQ(q[1] > 0.0, side) << "round " << round << ", frame " << frame;
      reached += followed.is_reached;
    }
  }
  EXPECT_GE(reached, 40 * 100 / 2);
}

/// Turns the hand of arm6 by 0.08 rad about an axis of its own, and waits there for the robot, at most 8
/// frames.
FollowedTip turned_and_waited_for(const Robot& arm6, const Configuration& begin, const Eigen::Vector3d& axis,
                                  int& frames) {
  const Eigen::Isometry3d pose = tip_pose(arm6, begin) * Eigen::AngleAxisd(0.08, axis);
  FollowedTip followed{begin, false, {}};
  for (frames = 0; frames < 8 && !followed.is_reached; ++frames) {
    const Configuration from = followed.q;
    followed = follow_tip(arm6, pose, from);
    EXPECT_LE((followed.q - from).lpNorm<Eigen::Infinity>(),
              largest_joint_move(arm6, tip_pose(arm6, from), pose) + 1e-9);
    EXPECT_TRUE(followed.is_reached || followed.reason.find("singular") != std::string::npos)
        << followed.reason;
  }
  return followed;
}

TEST(FollowTip, ANearlySingularArmComesAfterTheHandInFramesAndKeepsItsWrist) {
  const Robot robot = load_robot("arm6");
  const Configuration begin = (Configuration(6) << 0.3, -1.2, 1.4, 0.5, 0.02, 0.2).finished();
  Configuration singular = begin;
  singular[4] = 0.0;
  int slowest = 0, frames = 0, left = 0;
  for (int direction = 0; direction < 12; ++direction) {
    const double angle = direction * std::numbers::pi / 6.0;
    const Eigen::Vector3d axis(std::cos(angle), std::sin(angle), 0.0);
    const FollowedTip followed = turned_and_waited_for(robot, begin, axis, frames);
    EXPECT_TRUE(followed.is_reached) << direction << ": " << followed.reason;
    EXPECT_GT(followed.q[4], 0.0);
    slowest = std::max(slowest, frames);
    left += turned_and_waited_for(robot, singular, axis, frames).is_reached;
  }
  EXPECT_GE(slowest, 4);
  EXPECT_GE(left, 8);  // the others need the hand to move on
}

TEST(FollowTip, APumaTurnsNoJointBackByAWholeTurn) {
  const Robot robot = load_robot("puma560");
  Configuration q = (Configuration(6) << 0.2, -0.5, -0.4, 0.1, 0.6, 0.0).finished();
  q[5] = robot.joints[5].upper - 0.01;
  const Configuration from = q;
  q[5] += 0.06;
  const FollowedTip followed = follow_tip(robot, tip_pose(robot, q), from);
  EXPECT_FALSE(followed.is_reached);
  EXPECT_NEAR(followed.q[5], robot.joints[5].upper, 0.01);
  EXPECT_NE(followed.reason.find("joint '" + robot.joints[5].name + "' is at its limit"), std::string::npos)
      << followed.reason;
  EXPECT_TRUE(follow_tip(robot, tip_pose(robot, from), followed.q).is_reached);
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

/// Leads the tip straight away from the shoulder until no turn of it has a place there, by 15 % at least.
/// Says what the robot said at each place where an independent search finds nothing.
std::vector<std::string> reasons_beyond_reach(const Robot& robot, Configuration q) {
  const Eigen::Isometry3d begin = tip_pose(robot, q);
  const Eigen::Vector3d shoulder = forward_kinematics(robot, q)[2].translation();
  const Eigen::Vector3d out = begin.translation() - shoulder;
  const IkOptions thorough{.restarts = 30, .position_only = true};
  std::vector<std::string> reasons;
  double edge = 0.0;
  for (double part = 1.0; edge == 0.0 || part < 1.15 * edge; part += 0.03) {
    Eigen::Isometry3d pose = begin;
    pose.translation() = shoulder + part * out;
    const FollowedTip followed = follow_tip(robot, pose, q);
    q = followed.q;
    if (inverse_kinematics(robot, pose, q, thorough)) continue;
    if (edge == 0.0) edge = part;
    reasons.push_back(followed.reason);
  }
  return reasons;
}

/// With a finger on the hand that stands at its limit, as a closed gripper's does, and moves no tip.
Robot with_closed_finger(Robot robot) {
  Joint finger{.name = "finger_joint", .kind = JointKind::prismatic};
  finger.upper = 0.04;
  robot.joints.insert(robot.joints.begin(), finger);
  for (Link& link : robot.links)
    if (link.joint >= 0) ++link.joint;
  robot.links.push_back({.name = "finger", .parent = robot.tip_link, .joint = 0});
  return robot;
}

Configuration with_closed_finger(const Configuration& q) {
  Configuration all = Configuration::Zero(q.size() + 1);
  all.tail(q.size()) = q;
  return all;
}

/// Fingers beyond the tip are no joints of the arm: with five it follows the place alone, whatever its hand
/// has, and with six it keeps the turn, too.
TEST(FollowTip, AHandsFingersDoNotCountAsJointsOfTheArm) {
  Random random(23);
  for (const char* name : {"arm5", "arm6"}) {
    const Robot bare = load_robot(name), robot = with_closed_finger(with_closed_finger(bare));
    for (int round = 0; round < 20; ++round) {
      const Configuration from = inner(bare, random);
      Eigen::Isometry3d pose = tip_pose(bare, from);
      pose.translation() += random.point(0.02);
      pose.linear() = pose.linear() * Eigen::AngleAxisd(0.05, random.point(1.0).normalized());
      const FollowedTip expected = follow_tip(bare, pose, from),
                        found = follow_tip(robot, pose, with_closed_finger(with_closed_finger(from)));
      EXPECT_EQ(found.is_reached, expected.is_reached) << name << round << found.reason;
      EXPECT_LT((found.q.tail(from.size()) - expected.q).norm(), 1e-6) << name << round;
      EXPECT_EQ(found.q.head(2).norm(), 0.0);
    }
  }
}

TEST(FollowTip, APlaceBeyondReachIsReportedAsThatByEveryArm) {
  Random random(19);
  for (const char* name : {"arm6", "panda", "puma560"}) {
    const Robot robot = load_robot(name);
    for (int round = 0; round < 2; ++round)
      for (const std::string& reason : reasons_beyond_reach(robot, inner(robot, random)))
        EXPECT_EQ(reason.find("the tip is beyond the arm's reach"), 0U) << name << ": " << reason;
  }
}

TEST(FollowTip, AJointThatDoesNotMoveTheTipIsNeverToBlame) {
  Random random(20);
  const Robot arm = load_robot("arm6");
  const Robot robot = with_closed_finger(arm);
  for (int round = 0; round < 2; ++round) {
    const Configuration q = with_closed_finger(inner(arm, random));
    for (const std::string& reason : reasons_beyond_reach(robot, q))
      EXPECT_EQ(reason.find("the tip is beyond the arm's reach"), 0U) << reason;
    Robot limited = robot;
    limited.joints[1].upper = q[1] + 0.1;
    Configuration beyond = q;
    beyond[1] += 0.2;
    EXPECT_EQ(follow_tip(limited, tip_pose(robot, beyond), q).reason.find("joint '" + robot.joints[1].name),
              0U);
  }
}

TEST(FollowTip, OfTwoJointsAtTheirLimitsTheOneThatBindsIsNamed) {
  Robot robot = load_robot("arm6");
  const Configuration q = (Configuration(6) << 0.3, -1.2, 1.4, 0.5, 0.8, 0.2).finished();
  Configuration beyond = q;
  beyond[5] += 0.2;
  const Eigen::Isometry3d pose = tip_pose(robot, beyond);
  robot.joints[0].upper = q[0];  // which the hand asks for nothing
  robot.joints[5].upper = q[5] + 0.1;
  const FollowedTip followed = follow_tip(robot, pose, q);
  EXPECT_EQ(followed.reason.find("joint '" + robot.joints[5].name + "' is at its limit"), 0U)
      << followed.reason;
}

}  // namespace follow_tip_test
}  // namespace clearway
