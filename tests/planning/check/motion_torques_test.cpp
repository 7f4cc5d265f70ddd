#include "planning/check/motion_torques.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "mapping/system/plain_text.hpp"
#include "planning/robot/inverse_dynamics.hpp"
#include "planning/robot_files/load_robot.hpp"
#include "planning/robot_files/torque_terms.hpp"
#include "tests/planning/check/comma_locale.hpp"
#include "tests/worlds/random_world.hpp"
#include "tests/worlds/slide_robot.hpp"
#include "tests/worlds/urdf_robots.hpp"

namespace clearway {
namespace motion_torques_test {

/// Gravity comes from aside, so that the first joint has something to hold, too.
TEST(GreatestTorques, EachJointThatGravityAloneOverloadsIsNamedByItself) {
  for (const char* name : {"panda", "puma560"}) {
    const Robot robot = load_robot(name);
    TorqueTerms terms = torque_terms(robot, {.payload = 2.0, .gravity = {6.0, 5.0, -6.0}});
    Configuration q(robot.dof());
    for (Eigen::Index j = 0; j < q.size(); ++j) q[j] = 0.3 + 0.2 * static_cast<double>(j);
    const Eigen::VectorXd rest = Eigen::VectorXd::Zero(q.size());
    const Motion still{1.0, {q, q}, {rest, rest}, {rest, rest}};
    const Eigen::VectorXd held = joint_torques(robot, q, rest, rest, terms).cwiseAbs();
    ASSERT_GT(held[0], 1.0) << name;
    int tried = 0;
    for (Eigen::Index j = 0; j < q.size(); ++j) {
      if (held[j] < 1e-3) continue;
      ++tried;
      terms.limits = 100.0 * held + Eigen::VectorXd::Ones(q.size());
      const auto found_at = [&](double share) {
        terms.limits[j] = held[j] / share;
        return greatest_torques(robot, still, terms);
      };
      EXPECT_TRUE(found_at(0.94).overloaded.empty()) << name << ' ' << j;
      const TorqueFinding found = found_at(0.96);
      const std::vector<std::string> alone{robot.joints[static_cast<std::size_t>(j)].name};
      EXPECT_EQ(found.overloaded, alone) << name;
      EXPECT_EQ(found.joint, j) << name;
      EXPECT_NEAR(found.share, 0.96, 1e-9) << name << ' ' << j;
      EXPECT_EQ(torque_fault(robot, still.period, terms, found), "");
      // A motion at its limit is one that may be.
      for (const double share : {1.0 - 2e-7, 1.0 + 8e-7})
        EXPECT_EQ(torque_fault(robot, still.period, terms, found_at(share)), "") << name << ' ' << j;
      EXPECT_NE(torque_fault(robot, still.period, terms, found_at(1.0 + 2e-6)), "") << name << ' ' << j;
      const TorqueFinding beyond = found_at(1.1);
      EXPECT_NE(torque_fault(robot, still.period, terms, beyond), "") << name << ' ' << j;
    }
    EXPECT_GE(tried, 5) << name;
  }
}

/// Knots and places between them as the header says, one by one, by the torques that plan motions.
TEST(GreatestTorques, AreThoseOfTheFirstGreatestSampleOfAMotion) {
  const Robot robot = load_robot("panda");
  TorqueTerms terms = torque_terms(robot, {.payload = 1.5, .gravity = {3.0, 2.0, -8.0}});
  Random random(6);
  int between = 0;
  for (int trial = 0; trial < 20; ++trial) {
    const double period = random.between(0.004, 0.04);
    const Configuration q = random.configuration(robot);
    const Eigen::VectorXd way = 0.3 * (random.configuration(robot) - q), rest = 0.0 * way;
    const Motion motion{period,
                        {q, q + way, q + 2 * way},
                        {way / period, way / period, way / period},
                        {rest, rest, rest}};  // as fast everywhere
    int pieces = 1;
    while (period / pieces > 0.008 + 1e-9) ++pieces;
    TorqueFinding expected;
    const int last = static_cast<int>(motion.positions.size() - 1) * pieces;
    for (int i = 0; i <= last; ++i) {
      const MotionState state = motion.at(motion.duration() * i / last);
      const Eigen::VectorXd torques =
          joint_torques(robot, state.position, state.velocity, state.acceleration, terms);
      for (Eigen::Index j = 0; j < torques.size(); ++j) {
        const double share = std::abs(torques[j]) / terms.limits[j];
        if (share > expected.share * (1.0 + 1e-9)) expected = {share, torques[j], double(i) / pieces, j, {}};
      }
    }
    between += std::floor(expected.place) != expected.place;
    const TorqueFinding found = greatest_torques(robot, motion, terms);
    EXPECT_NEAR(found.share, expected.share, 1e-6 * expected.share) << trial;
    EXPECT_NEAR(found.torque, expected.torque, 1e-6 * std::abs(expected.torque)) << trial;
    EXPECT_NEAR(found.place, expected.place, 1e-9) << trial;
    EXPECT_EQ(found.joint, expected.joint) << trial;
  }
  EXPECT_GT(between, 3);
}

TEST(GreatestTorques, OfMomentsAreThatOfTheGreatestAndOfNoNumberAreNone) {
  const Robot robot = load_robot("panda");
  TorqueTerms terms = torque_terms(robot);
  const Configuration q = Configuration::Constant(7, 0.5);
  const Eigen::VectorXd rest = Eigen::VectorXd::Zero(7), lost = Eigen::VectorXd::Constant(7, std::nan(""));
  const MotionState still{q, rest, rest, {}}, fast{q, rest, Eigen::VectorXd::Constant(7, 3.0), {}};
  const TorqueFinding found = greatest_torques(robot, {{0.5, still}, {0.75, fast}, {1.0, still}}, terms);
  EXPECT_EQ(found.place, 0.75);
  EXPECT_NEAR(found.torque, joint_torques(robot, q, rest, fast.acceleration, terms)[found.joint], 1e-9);
  const TorqueFinding none = greatest_torques(robot, {{0.5, {q, rest, lost, {}}}, {0.75, fast}}, terms);
  EXPECT_TRUE(std::isnan(none.share));
  EXPECT_EQ(none.place, 0.5);
  EXPECT_NE(torque_fault(robot, 1.0, terms, none), "");
  terms.limits.setConstant(std::numeric_limits<double>::infinity());
  EXPECT_EQ(greatest_torques(robot, {{0.75, fast}}, terms).share, 0.0);
  terms.limits[6] = 1e-3;  // one limit alone is looked at
  EXPECT_EQ(greatest_torques(robot, {{0.75, fast}}, terms).joint, 6);
  EXPECT_GT(greatest_torques(robot, {{0.75, fast}}, terms).share, 1.0);
  terms.limits.resize(0);
  EXPECT_EQ(greatest_torques(robot, {{0.75, fast}}, terms).share, 0.0);
}

/// Slides, mimic joints and branches, wherever the base stands and however it is turned: KDL's dynamics are
/// those by which motions are planned.
TEST(GreatestTorques, AreKdlsForEveryKindOfJointWhereverTheBaseStands) {
  const worlds::UrdfRobot whip = worlds::whip(), telescope = worlds::telescope(),
                          scissors = worlds::scissors(), rack = worlds::rack_and_pinion();
  Random random(8);
  for (Robot robot : {whip.robot(), telescope.robot(), scissors.robot(), rack.robot(), load_robot("panda")}) {
    TorqueTerms terms = torque_terms(robot, {.payload = 1.5, .gravity = {3.0, 2.0, -8.0}});
    for (std::size_t i = 0; i < robot.links.size(); ++i) {
      robot.links[i].mass = random.between(0.5, 3.0);
      robot.links[i].center_of_mass = random.point(0.2);
      const Eigen::Matrix3d turn = random.pose(0.0).linear();
      terms.inertia[i] = turn * Eigen::Vector3d(0.02, 0.03, 0.04).asDiagonal() * turn.transpose();
    }
    for (int trial = 0; trial < 10; ++trial) {
      robot.map_from_base = random.pose(1.0);
      const Configuration q = random.configuration(robot);
      const Eigen::VectorXd velocity = random.configuration(robot),
                            acceleration = random.configuration(robot);
      const Eigen::VectorXd expected = joint_torques(robot, q, velocity, acceleration, terms);
      EXPECT_LT((kdl_torques(robot, q, velocity, acceleration, terms) - expected).norm(),
                1e-9 * (1.0 + expected.norm()))
          << robot.name << trial;
    }
  }
}

TEST(GreatestTorques, OfARobotOfOneJointAreLookedAtToo) {
  Robot robot = worlds::slide_robot();
  robot.links[1].mass = 2.0;
  const TorqueTerms terms{
      {Eigen::Matrix3d::Zero(), Eigen::Matrix3d::Zero()}, Eigen::VectorXd::Constant(1, 8.0), {}};
  const Eigen::VectorXd zero = Eigen::VectorXd::Zero(1), fast = Eigen::VectorXd::Constant(1, 3.0);
  const TorqueFinding found = greatest_torques(robot, {{1.0, {zero, zero, fast, {}}}}, terms);
  EXPECT_NEAR(found.torque, 6.0, 1e-9);
  EXPECT_NEAR(found.share, 0.75, 1e-9);
}

TEST(GreatestTorques, TheSentenceNamesTimeJointTorqueAndLimit) {
  const Robot robot = load_robot("panda");
  TorqueTerms terms = torque_terms(robot);
  terms.limits[2] = 12.0;
  EXPECT_EQ(torque_fault(robot, 0.25, terms, {1.5, -18.0, 5.0, 2, {}}),
            "motion: after 1.25 s the torque of joint " + shortened(robot.joints[2].name) +
                " is -18, beyond its limit of 12, the URDF's effort");
  expect_same_in_every_locale(
      [&] {
        return torque_fault(robot, 0.25, terms, {1.5, -18.25, 5.0, 2, {}});
      },
      "is -18.25, beyond its limit of 12");
  EXPECT_EQ(torque_fault(robot, 0.25, terms, {1.1, 13.2, 5.0, 2, {}}, 0.2), "");
  EXPECT_NE(torque_fault(robot, 0.25, terms, {1.3, 13.2, 5.0, 2, {}}, 0.2), "");
}

}  // namespace motion_torques_test
}  // namespace clearway
