#include "planning/path/path_torques.hpp"

#include <gtest/gtest.h>

#include <limits>

#include "planning/path/path_timing.hpp"
#include "planning/robot_files/load_robot.hpp"
#include "planning/robot_files/torque_terms.hpp"
#include "tests/worlds/random_world.hpp"

namespace clearway {
namespace path_torques_test {

SmoothPath random_path(Random& random, const Robot& robot) {
  std::vector<Configuration> path{random.configuration(robot)};
  while (path.size() < 4) path.push_back(path.back() + 0.3 * (random.configuration(robot) - path.back()));
  std::vector<double> reach(path.size(), 0.0);
  for (std::size_t i = 1; i + 1 < path.size(); ++i)
    reach[i] = 0.4 * std::min((path[i] - path[i - 1]).norm(), (path[i + 1] - path[i]).norm());
  return blended_path(path, reach);
}

TEST(PathTorques, AreThoseOfTheMotionWithThatSpeedAndAccelerationAlongThePath) {
  const Robot robot = load_robot("panda");
  TorqueTerms terms = torque_terms(robot);
  terms.limits = Eigen::VectorXd::LinSpaced(7, 200, 320);
  terms.limits[2] = std::numeric_limits<double>::infinity();
  Random random(5);
  for (int trial = 0; trial < 5; ++trial) {
    const SmoothPath path = random_path(random, robot);
    const std::vector<PathStretch> stretches = timed_stretches(path);
    const std::vector<StretchTorques> torques = torques_along(path, stretches, robot, terms, terms.limits);
    ASSERT_EQ(torques.size(), stretches.size());
    for (std::size_t k = 0; k < stretches.size(); k += 7) {
      const PathPiece& piece = path.pieces[stretches[k].piece];
      for (const bool at_end : {false, true}) {
        const TorqueBounds& bounds = at_end ? torques[k].end : torques[k].begin;
        const double s = stretches[k].begin + (at_end ? stretches[k].length : 0.0);
        const double x = random.between(0, 4), u = random.between(-5, 5);
        const Eigen::VectorXd slope = piece.slope(s);
        const Eigen::VectorXd expected =
            joint_torques(robot, piece.at(s), std::sqrt(x) * slope, u * slope + x * piece.bend, terms);
        ASSERT_EQ(bounds.along.size(), 6);
        for (Eigen::Index i = 0; i < 6; ++i) {
          const Eigen::Index joint = i < 2 ? i : i + 1;
          const double moved = bounds.along[i] * u + bounds.across[i] * x;
          EXPECT_NEAR(terms.limits[joint] - expected[joint], bounds.high[i] - moved, 1e-9);
          EXPECT_NEAR(-terms.limits[joint] - expected[joint], bounds.low[i] - moved, 1e-9);
        }
      }
    }
  }
}

TEST(PathTorques, AreKeptByTheFastestMotionWhichTheyBind) {
  const Robot robot = load_robot("panda");
  TorqueTerms terms = torque_terms(robot);
  Random random(6);
  constexpr double step = 1e-4;
  const Eigen::VectorXd velocity = Eigen::VectorXd::Constant(7, 2.0),
                        acceleration = Eigen::VectorXd::Constant(7, 500.0);
  int bound = 0;
  for (int trial = 0; trial < 4; ++trial) {
    const SmoothPath path = random_path(random, robot);
    terms.limits = Eigen::VectorXd::Constant(7, 90.0);
    const auto torques = torques_along(path, timed_stretches(path), robot, terms, terms.limits);
    const auto q = time_optimal_samples(path, velocity, acceleration, step, 0.0, {&torques, 1.0}).positions;
    double most = 0.0;
    for (std::size_t k = 10; k + 10 < q.size(); k += 10) {
      const Eigen::VectorXd v = (q[k + 1] - q[k - 1]) / (2 * step),
                            a = (q[k + 1] - 2 * q[k] + q[k - 1]) / (step * step);
      most = std::max(most, joint_torques(robot, q[k], v, a, terms).cwiseAbs().maxCoeff());
    }
    EXPECT_LT(most, 1.03 * 90.0) << trial;
    EXPECT_GT(most, 0.9 * 90.0) << trial;
    const std::size_t free = time_optimal_samples(path, velocity, acceleration, step).positions.size();
    EXPECT_LE(free, q.size()) << trial;
    bound += free < q.size();
  }
  EXPECT_GE(bound, 3);
}

}  // namespace path_torques_test
}  // namespace clearway
