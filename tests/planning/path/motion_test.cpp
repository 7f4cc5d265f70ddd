#include "planning/path/motion.hpp"

#include <gtest/gtest.h>

#include "planning/robot_files/load_robot.hpp"
#include "tests/worlds/random_world.hpp"

namespace clearway {
namespace motion_test {

Motion random_motion(Random& random, Eigen::Index n) {
  std::vector<Configuration> control;
  for (int i = 0; i < 30; ++i) {
    Configuration q(n);
    for (double& value : q) value = random.between(-1, 1);
    control.push_back(q);
  }
  return spline_motion(control, 0.02);
}

TEST(SplineMotion, IsTheCubicsThroughItsPositionsAndVelocities) {
  Random random(1);
  const Motion motion = random_motion(random, 3);
  for (std::size_t k = 0; k + 1 < motion.positions.size(); ++k) {
    const double h = motion.period, t = h * static_cast<double>(k + 1);
    const MotionState end = motion.at(t - 1e-12);  // of the cubic before the knot
    EXPECT_LT((end.position - motion.positions[k + 1]).norm(), 1e-9);
    EXPECT_LT((end.velocity - motion.velocities[k + 1]).norm(), 1e-6);
    EXPECT_LT((end.acceleration - motion.accelerations[k + 1]).norm(), 1e-4);
  }
  const auto hermite = hermite_accelerations(motion);
  ASSERT_EQ(hermite.size(), motion.accelerations.size());
  for (std::size_t k = 0; k < hermite.size(); ++k)
    EXPECT_LT((hermite[k] - motion.accelerations[k]).norm(), 1e-8 * motion.accelerations[k].norm() + 1e-8);
}

TEST(SplineMotion, GreatestRatesAreThoseOfAFineSampling) {
  Random random(2);
  for (int trial = 0; trial < 20; ++trial) {
    const Motion motion = random_motion(random, 2);
    const RateLimits rates = greatest_rates(motion);
    Eigen::VectorXd velocity = Eigen::VectorXd::Zero(2), acceleration = velocity, jerk = velocity;
    const double end = motion.duration(), h = 1e-5;
    for (double t = h; t < end; t += h) {  // by differences of positions alone
      velocity = velocity.cwiseMax((motion.at(t).position - motion.at(t - h).position).cwiseAbs() / h);
      acceleration = acceleration.cwiseMax(motion.at(t).acceleration.cwiseAbs());
      jerk = jerk.cwiseMax(motion.at(t).jerk.cwiseAbs());
    }
    EXPECT_LT((rates.velocity - velocity).norm(), 1e-3 * velocity.norm());
    EXPECT_LT((rates.acceleration - acceleration).norm(), 1e-2 * acceleration.norm());
    EXPECT_LT((rates.jerk - jerk).norm(), 1e-9 * jerk.norm());
  }
}

TEST(GreatestRates, OfNoMotionAreOfNoJoint) { EXPECT_EQ(greatest_rates(Motion{}).velocity.size(), 0); }

TEST(SplineMotion, EqualControlPointsRestBitForBit) {
  const Configuration q = Eigen::Vector2d(0.1, -1.0 / 3.0);
  const Motion motion = spline_motion({q, q, q, q}, 0.008);
  ASSERT_EQ(motion.positions.size(), 2U);
  EXPECT_EQ(motion.positions[0], q);
  EXPECT_EQ(motion.velocities[1], Eigen::VectorXd::Zero(2));
}

TEST(SplineMotion, LimitsAreTheRobotsOwnElseTheDefaultsTimesTheScales) {
  Robot robot = load_robot("planar2");
  robot.joints[0].max_velocity = 2.0;
  robot.joints[0].max_acceleration = 8.0;
  robot.joints[0].max_jerk = 70.0;
  robot.joints[1].max_velocity = robot.joints[1].max_acceleration = robot.joints[1].max_jerk = 0.0;
  const RateLimits limits = rate_limits(robot, {.speed = 0.5, .acceleration = 0.25, .jerk = 0.1});
  EXPECT_EQ(limits.velocity, Eigen::Vector2d(1.0, 0.5));
  EXPECT_EQ(limits.acceleration, Eigen::Vector2d(2.0, 1.25));
  EXPECT_TRUE(limits.jerk.isApprox(Eigen::Vector2d(7.0, 10.0)));
  for (const double scale : {0.0, -1.0, 1.0000001, std::nan("")})
    EXPECT_THROW(rate_limits(robot, {.speed = scale}), std::invalid_argument) << scale;
}

}  // namespace motion_test
}  // namespace clearway
