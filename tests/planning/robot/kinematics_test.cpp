#include "planning/robot/kinematics.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include <kdl/chainfksolverpos_recursive.hpp>
#include <kdl/chainjnttojacsolver.hpp>
#include <kdl_parser/kdl_parser.hpp>
#include <numbers>
#include <random>

#include "planning/robot/puma_branches.hpp"
#include "planning/robot_files/load_robot.hpp"
#include "planning/robot_files/urdf_document.hpp"
#include "tests/worlds/random_world.hpp"
#include "tests/worlds/urdf_robots.hpp"

namespace clearway {
namespace kinematics_test {

Eigen::Isometry3d isometry(const KDL::Frame& frame) {
  Eigen::Isometry3d pose = Eigen::Isometry3d::Identity();
  for (int i = 0; i < 3; ++i) {
    pose.translation()[i] = frame.p(i);
    for (int k = 0; k < 3; ++k) pose.linear()(i, k) = frame.M(i, k);
  }
  return pose;
}

class KinematicsOf : public testing::TestWithParam<const char*> {};

TEST_P(KinematicsOf, PosesAndJacobiansAgreeWithKdlReadingTheSameUrdf) {
  const Robot robot = load_robot(GetParam());
  KDL::Tree tree;
  // The file's own text, with <capsule> as <cylinder>: kdl_parser knows no capsules.
  const auto urdf = read_urdf_document(datasets_folder() / "robots" / (std::string(GetParam()) + ".urdf"));
  ASSERT_TRUE(kdl_parser::treeFromString(urdf.text, tree));
  KDL::Chain chain;
  ASSERT_TRUE(tree.getChain(robot.links.front().name,
                            robot.links[static_cast<std::size_t>(robot.tip_link)].name, chain));
  ASSERT_EQ(chain.getNrOfJoints(), robot.dof());
  KDL::ChainFkSolverPos_recursive positions(chain);
  KDL::ChainJntToJacSolver jacobians(chain);
  Random random(1);
  double worst_pose = 0.0, worst_jacobian = 0.0;
  for (int i = 0; i < 10'000; ++i) {
    const Configuration q = random.configuration(robot);
    KDL::JntArray joints(static_cast<unsigned>(robot.dof()));
    joints.data = q;
    KDL::Frame frame;
    KDL::Jacobian expected(static_cast<unsigned>(robot.dof()));
    positions.JntToCart(joints, frame);
    jacobians.JntToJac(joints, expected);
    const LinkPoses poses = forward_kinematics(robot, q);
    const Eigen::Isometry3d& tip = poses[static_cast<std::size_t>(robot.tip_link)];
    worst_pose = std::max(worst_pose, (tip.matrix() - isometry(frame).matrix()).cwiseAbs().maxCoeff());
    const auto ours = jacobian(robot, poses, robot.tip_link, tip.translation());
    worst_jacobian = std::max(worst_jacobian, (ours - expected.data).cwiseAbs().maxCoeff());
  }
  EXPECT_LT(worst_pose, 1e-9);
  EXPECT_LT(worst_jacobian, 1e-9);
}

INSTANTIATE_TEST_SUITE_P(Robots, KinematicsOf,
                         testing::Values("puma560", "panda", "arm5", "arm6", "planar2", "point"));

TEST(Kinematics, ARootThatStandsOffItsBaseTakesItsChildrenWithIt) {
  Robot robot;
  robot.map_from_base.translation() = Eigen::Vector3d(0.0, 0.0, 5.0);
  robot.links.resize(3);
  robot.links[0].parent_from_link.translation() = Eigen::Vector3d(1.0, 0.0, 0.0);
  for (int i = 1; i < 3; ++i) {
    robot.links[static_cast<std::size_t>(i)].parent = i - 1;
    robot.links[static_cast<std::size_t>(i)].parent_from_link.translation() = Eigen::Vector3d(0.0, 2.0, 0.0);
  }
  const LinkPoses poses = forward_kinematics(robot, Configuration());
  EXPECT_EQ(poses[0].translation(), Eigen::Vector3d(1.0, 0.0, 5.0));
  EXPECT_EQ(poses[1].translation(), Eigen::Vector3d(1.0, 2.0, 5.0));
  EXPECT_EQ(poses[2].translation(), Eigen::Vector3d(1.0, 4.0, 5.0));
}

TEST(Kinematics, JacobianIsTheNumericDerivativeOfAPointOnALink) {
  for (const char* name : {"puma560_miniature", "arm5", "planar2", "point"}) {
    Robot robot = load_robot(name);
    Random random(2);
    robot.map_from_base = random.pose(1.0);
    for (int i = 0; i < 200; ++i) {
      const Configuration q = random.configuration(robot);
      const int link = random.below(static_cast<int>(robot.links.size()));
      const Eigen::Vector3d local = random.point(0.2);
      const auto place = [&](const Configuration& at) {
        return Eigen::Vector3d(forward_kinematics(robot, at)[static_cast<std::size_t>(link)] * local);
      };
      const auto columns = jacobian(robot, forward_kinematics(robot, q), link, place(q));
      for (Eigen::Index j = 0; j < q.size(); ++j) {
        Configuration up = q, down = q;
        up[j] += 1e-6;
        down[j] -= 1e-6;
        EXPECT_LT(((place(up) - place(down)) / 2e-6 - columns.col(j).head<3>()).norm(), 1e-7)
            << name << " joint " << j;
      }
    }
  }
}

TEST(Kinematics, OfAnotherNumberOfJointValuesIsRefused) {
  const Robot robot = load_robot("puma560");
  for (const Eigen::Index count : {0, 5, 7}) {
    EXPECT_THROW(tip_pose(robot, Configuration::Zero(count)), std::invalid_argument);
    EXPECT_THROW(forward_kinematics(robot, Configuration::Zero(count)), std::invalid_argument);
  }
}

TEST(Kinematics, ATipThatIsNoLinkIsRefused) {
  Robot robot = load_robot("planar2");
  for (const int tip : {-1, 99}) {
    robot.tip_link = tip;
    EXPECT_THROW(tip_pose(robot, Configuration::Zero(2)), std::invalid_argument);
  }
}

TEST(Kinematics, LimitViolationNamesJointValueAndLimit) {
  const Robot robot = load_robot("planar2");
  EXPECT_EQ(limit_violation(robot, Eigen::Vector2d(1.0, -1.0)), "");
  EXPECT_EQ(limit_violation(robot, Eigen::Vector2d(1.0, 3.0)),
            "joint elbow is 3 rad, above its upper limit 2.79253 rad");
  EXPECT_EQ(limit_violation(robot, Eigen::Vector2d(-4.0, 0.0)),
            "joint shoulder is -4 rad, below its lower limit -3.14159 rad");
  EXPECT_EQ(limit_violation(robot, Eigen::Vector2d(0.0, NAN)),
            "joint elbow is nan, expected a finite number");
  EXPECT_EQ(limit_violation(robot, Eigen::Vector3d::Zero()),
            "the configuration has 3 values, but planar2 has 2 joints");
}

/// A joint without limits, and one that follows it: a whole turn of the first is one of all only where the
/// second makes whole turns, too.
TEST(Kinematics, WholeTurnsLeaveAllLinksOnlyWhereWhatFollowsMakesWholeTurns) {
  std::mt19937_64 random(3);
  const auto angle = [&](double most) { return std::uniform_real_distribution<double>(-most, most)(random); };
  for (const double multiplier : {1.0, -2.0, 3.0, 0.5, -0.25, 1.75}) {
    const worlds::UrdfRobot geared = worlds::geared(multiplier, "0.05", "0.3 0 0", "0.3 0 0");
    const Robot robot = geared.robot();
    for (int i = 0; i < 20; ++i) {
      const Configuration q = Eigen::VectorXd::Constant(1, angle(3.0));
      const Configuration near = Eigen::VectorXd::Constant(1, angle(30.0));
      const Configuration turned = by_whole_turns(robot, q, near);
      const Configuration one_on = Eigen::VectorXd::Constant(1, q[0] + 2.0 * std::numbers::pi);
      double moved = 0.0, moved_by_one = 0.0;
      const LinkPoses before = forward_kinematics(robot, q), after = forward_kinematics(robot, turned);
      const LinkPoses next = forward_kinematics(robot, one_on);
      for (std::size_t link = 0; link < before.size(); ++link) {
        moved = std::max(moved, (before[link].matrix() - after[link].matrix()).cwiseAbs().maxCoeff());
        moved_by_one =
            std::max(moved_by_one, (before[link].matrix() - next[link].matrix()).cwiseAbs().maxCoeff());
      }
      EXPECT_LT(moved, 1e-12) << multiplier;
      EXPECT_EQ(repeats_after_turns(robot, 0), moved_by_one < 1e-9) << multiplier;
      EXPECT_TRUE(!repeats_after_turns(robot, 0) || std::abs(turned[0] - near[0]) <= std::numbers::pi + 1e-9);
    }
    EXPECT_NE(limit_violation(robot, Eigen::VectorXd::Constant(1, -1.1e6)).find("expected at most 1000000"),
              std::string::npos);
    EXPECT_EQ(limit_violation(robot, Eigen::VectorXd::Constant(1, 0.9e6)), "");
  }
  const Robot limited = load_robot("planar2");
  EXPECT_FALSE(repeats_after_turns(limited, 0));
  EXPECT_EQ(by_whole_turns(limited, Eigen::Vector2d(1, 1), Eigen::Vector2d(9, 9)), Eigen::Vector2d(1, 1));
}

double pose_error(const Eigen::Isometry3d& a, const Eigen::Isometry3d& b) {
  return (a.matrix() - b.matrix()).cwiseAbs().maxCoeff();
}

TEST(PumaInverseKinematics, AllSolutionsReachThePoseAndOneIsWhereItCameFrom) {
  for (double scale : {1.0, 0.1}) {
    Robot robot = scaled(load_robot("puma560"), scale);
    Random random(3);
    robot.map_from_base = random.pose(2.0);
    int solutions = 0;
    for (int i = 0; i < 10'000; ++i) {
      const Configuration q = random.configuration(robot);
      const Eigen::Isometry3d target = tip_pose(robot, q);
      double nearest = 1e300;
      for (const Configuration& solution : puma_inverse_kinematics(robot, target)) {
        ++solutions;
        ASSERT_EQ(limit_violation(robot, solution), "");
        ASSERT_LT(pose_error(tip_pose(robot, solution), target), 1e-9);
        double turn = 0.0;
        for (Eigen::Index j = 0; j < 6; ++j)
          turn = std::max(turn, std::abs(std::remainder(solution[j] - q[j], 2 * std::numbers::pi)));
        nearest = std::min(nearest, turn);
      }
      ASSERT_LT(nearest, 1e-5) << q.transpose();
    }
    EXPECT_GT(solutions, 20'000);
  }
}

TEST(PumaInverseKinematics, KeepsTheArmConfigurationAndMovesLittleForASmallMoveOfTheHand) {
  const Robot robot = load_robot("puma560_miniature");
  Random random(4);
  int followed = 0;
  for (int i = 0; i < 2'000; ++i) {
    Configuration q = random.configuration(robot);
    if (std::abs(q[4]) < 0.3) continue;  // near the wrist's singularity small moves need large turns
    Eigen::Isometry3d target = tip_pose(robot, q);
    target.translation() += random.point(1e-5);
    const auto solution = inverse_kinematics(robot, target, q);
    if (!solution) continue;
    ++followed;
    EXPECT_LT(pose_error(tip_pose(robot, *solution), target), 1e-9);
    EXPECT_LT((*solution - q).cwiseAbs().maxCoeff(), 0.05);
  }
  EXPECT_GT(followed, 1'500);
}

TEST(PumaInverseKinematics, AtTheWristSingularityTheFourthJointStays) {
  const Robot robot = load_robot("puma560");
  Configuration q(6);
  q << 0.3, -0.8, -1.0, 0.7, 0.0, 0.4;
  const auto solution = inverse_kinematics(robot, tip_pose(robot, q), q);
  ASSERT_TRUE(solution);
  EXPECT_LT((*solution - q).cwiseAbs().maxCoeff(), 1e-6);
}

TEST(InverseKinematics, IsEmptyOutOfReachAndForBadInput) {
  for (const char* name : {"puma560", "arm5"}) {
    const Robot robot = load_robot(name);
    const Configuration q = Configuration::Zero(static_cast<Eigen::Index>(robot.dof()));
    Eigen::Isometry3d far = tip_pose(robot, q);
    far.translation().x() += 10.0;
    EXPECT_FALSE(inverse_kinematics(robot, far, q));
    far.translation().x() = NAN;
    EXPECT_FALSE(inverse_kinematics(robot, far, q));
    EXPECT_THROW(inverse_kinematics(robot, tip_pose(robot, q), Configuration::Zero(1)),
                 std::invalid_argument);
  }
  EXPECT_THROW(puma_inverse_kinematics(load_robot("planar2"), Eigen::Isometry3d::Identity()),
               std::invalid_argument);
  Robot planar = load_robot("planar2");
  const Configuration two = Configuration::Zero(2);
  EXPECT_THROW(inverse_kinematics(planar, tip_pose(planar, two), two, {.free_axis = 7}),
               std::invalid_argument);
  planar.inverse_kinematics = "puma";
  EXPECT_THROW(inverse_kinematics(planar, tip_pose(planar, two), two), std::invalid_argument);
}

TEST(InverseKinematics, NumericSolverReachesRandomPosesWithinTolerance) {
  Robot puma = load_robot("puma560");
  puma.inverse_kinematics = "numeric";
  for (const Robot& robot : {puma, load_robot("arm5"), load_robot("planar2"), load_robot("point")}) {
    Random random(5);
    int solved = 0;
    for (int i = 0; i < 100; ++i) {
      const Eigen::Isometry3d target = tip_pose(robot, random.configuration(robot));
      const auto q = inverse_kinematics(robot, target, random.configuration(robot));
      if (!q) continue;
      ++solved;
      EXPECT_EQ(limit_violation(robot, *q), "");
      EXPECT_LT(pose_error(tip_pose(robot, *q), target), 5e-6);
    }
    EXPECT_GE(solved, 95) << robot.name;
  }
}

/// Of an arm whose joints make two turns each the answer is at the turn of each joint that is nearest.
TEST(InverseKinematics, SlidingJointsAreFoundAtAnyScale) {
  Robot slides = load_robot("puma560");
  slides.inverse_kinematics = "numeric";
  for (const std::size_t j : {3U, 5U}) {
    slides.joints[j].kind = JointKind::prismatic;
    slides.joints[j].lower = -0.1, slides.joints[j].upper = 0.1;
  }
  for (const double scale : {0.02, 1.0, 20.0}) {
    const Robot robot = scaled(slides, scale);
    Random random(6);
    int solved = 0;
    for (int i = 0; i < 50; ++i) {
      const Eigen::Isometry3d target = tip_pose(robot, random.configuration(robot));
      const auto q = inverse_kinematics(robot, target, random.configuration(robot));
      if (!q) continue;
      ++solved;
      EXPECT_LT(pose_error(tip_pose(robot, *q), target), 5e-6 * std::max(1.0, scale));
    }
    EXPECT_GE(solved, 48) << scale;
  }
}

TEST(InverseKinematics, NoJointIsMoreThanATurnFromWhereItIsAskedToBeNear) {
  Robot robot = load_robot("arm6");
  for (Joint& joint : robot.joints)
    joint.lower = -2.0 * std::numbers::pi, joint.upper = 2.0 * std::numbers::pi;
  Random random(12);
  int solved = 0;
  for (int i = 0; i < 100; ++i) {
    const Configuration q = random.configuration(robot);
    Configuration near = q;
    for (double& value : near) value = std::clamp(value + 0.5 * (random.unit() - 0.5), -6.28, 6.28);
    const auto found = inverse_kinematics(robot, tip_pose(robot, q), near);
    if (!found) continue;
    ++solved;
    EXPECT_LT(pose_error(tip_pose(robot, *found), tip_pose(robot, q)), 1e-5);
    EXPECT_EQ(limit_violation(robot, *found), "");
    for (Eigen::Index j = 0; j < 6; ++j) {
      const double back = (*found)[j] + 2.0 * std::numbers::pi * ((*found)[j] < near[j] ? 1.0 : -1.0);
      EXPECT_TRUE(std::abs(back) > 2.0 * std::numbers::pi ||
                  std::abs((*found)[j] - near[j]) <= std::abs(back - near[j]) + 1e-9);
    }
  }
  EXPECT_GT(solved, 90);
}

TEST(MovesTip, AsTurningTheJointTells) {
  for (const char* name : {"puma560", "panda", "arm5"}) {
    Robot robot = load_robot(name);
    robot.tip_link /= 2;  // the joints beyond it are some that do not
    const Configuration q = Eigen::VectorXd::Zero(static_cast<Eigen::Index>(robot.dof()));
    for (std::size_t j = 0; j < robot.dof(); ++j) {
      Configuration turned = q;
      turned[static_cast<Eigen::Index>(j)] += 0.01;
      EXPECT_EQ(moves_tip(robot, j), pose_error(tip_pose(robot, q), tip_pose(robot, turned)) > 1e-6)
          << name << ", " << robot.joints[j].name;
    }
  }
}

/// A joint of several turns, and one that follows it by half: a whole turn of the first is another pose.
TEST(InverseKinematics, JointsThatOthersFollowByHalfAreNotTurned) {
  for (const double multiplier : {0.5, 2.0}) {
    const worlds::UrdfRobot geared = worlds::geared(multiplier, "0.05", "0.3 0 0", "0.3 0 0");
    Robot robot = geared.robot();
    robot.joints[0].lower = -20.0, robot.joints[0].upper = 20.0;
    const Configuration q = Eigen::VectorXd::Constant(1, 0.4), near = Eigen::VectorXd::Constant(1, 7.0);
    const auto turned = unwrapped_within_limits(robot, q, near);
    ASSERT_TRUE(turned);
    EXPECT_EQ(*turned == q, multiplier == 0.5);
    const LinkPoses before = forward_kinematics(robot, q), after = forward_kinematics(robot, *turned);
    for (std::size_t i = 0; i < before.size(); ++i) EXPECT_LT(pose_error(before[i], after[i]), 1e-12);
  }
}

}  // namespace kinematics_test
}  // namespace clearway
