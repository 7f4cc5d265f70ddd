#include "planning/path/motion_section.hpp"

#include <gtest/gtest.h>

#include "planning/robot_files/load_robot.hpp"
#include "planning/robot_files/torque_terms.hpp"
#include "tests/worlds/random_world.hpp"

namespace clearway {
namespace motion_section_test {

using Path = std::vector<Configuration>;

constexpr double period = 0.008;

double duration(const Robot& robot, const Path& path, const RateLimits& limits,
                const std::shared_ptr<const TorqueTerms>& torques = nullptr) {
  MotionSection section = section_of(path, 0.5);
  time_section(section, robot, limits, {.torques = torques, .period = period});
  return section.motion.duration();
}

Path random_path(Random& random, const Robot& robot, int waypoints) {
  Path path{random.configuration(robot)};
  while (path.size() < static_cast<std::size_t>(waypoints))
    path.push_back(path.back() + 0.3 * (random.configuration(robot) - path.back()));
  return path;
}

/// Acceleration builds up in 10 to 200 ms.
RateLimits random_limits(Random& random, Eigen::Index dof) {
  RateLimits limits{Eigen::VectorXd(dof), Eigen::VectorXd(dof), Eigen::VectorXd(dof)};
  for (Eigen::Index j = 0; j < dof; ++j) {
    limits.velocity[j] = random.between(0.3, 3.0);
    limits.acceleration[j] = std::pow(10.0, random.between(-0.3, 1.3));
    limits.jerk[j] = limits.acceleration[j] / random.between(0.01, 0.2);
  }
  return limits;
}

TEST(MotionSection, WiderLimitsDoNotSlowAMotionByMoreThanAPercent) {
  Random random(11);
  for (int trial = 0; trial < 40; ++trial) {
    const Robot robot = load_robot(trial % 2 ? "panda" : "point");
    const Path path = random_path(random, robot, 2 + random.below(6));
    RateLimits limits = random_limits(random, path.front().size());
    double least = duration(robot, path, limits);
    for (int wider = 0; wider < 8; ++wider) {
      Eigen::VectorXd* const each[] = {&limits.velocity, &limits.acceleration, &limits.jerk};
      for (int kind = 0; kind < 3; ++kind)
        if (trial % 4 == kind || trial % 4 == 3) *each[kind] *= trial % 4 == 3 ? random.between(1, 2) : 2.0;
      const double now = duration(robot, path, limits);
      EXPECT_LE(now, 1.01 * least + 2 * period) << trial << " " << wider;
      least = std::min(least, now);
    }
  }
}

/// Without its limits of acceleration an arm may move as fast as its torques allow.
TEST(MotionSection, WhereTorquesBindWiderLimitsDoNotSlowAMotionEither) {
  Random random(12);
  int bound = 0;
  for (int trial = 0; trial < 8; ++trial) {
    const Robot robot = load_robot(trial % 2 ? "panda" : "arm6");
    const Path path = random_path(random, robot, trial < 6 ? 2 : 5);
    RateLimits limits = random_limits(random, path.front().size());
    TorqueTerms terms = torque_terms(robot);
    const Eigen::VectorXd rest = Eigen::VectorXd::Zero(path.front().size());
    Eigen::VectorXd held = rest;
    for (std::size_t i = 0; i + 1 < path.size(); ++i)
      for (double share = 0.0; share <= 1.0; share += 0.05)
        held = held.cwiseMax(
            joint_torques(robot, path[i] + share * (path[i + 1] - path[i]), rest, rest, terms).cwiseAbs());
    terms.limits = 1.4 * held + Eigen::VectorXd::Constant(rest.size(), 1.0);
    const auto torques = std::make_shared<const TorqueTerms>(terms);
    double least = duration(robot, path, limits, torques);
    for (int wider = 0; wider < 6; ++wider) {
      limits.acceleration *= 2.0;
      limits.jerk *= 2.0;
      const double now = duration(robot, path, limits, torques);
      EXPECT_LE(now, (path.size() == 2 ? 1.01 : 1.04) * least + 2 * period) << trial << " " << wider;
      least = std::min(least, now);
    }
    bound += least > 1.1 * duration(robot, path, limits);
  }
  EXPECT_GT(bound, 4);
}

TEST(MotionSection, AccelerationWithoutAnyLimitIsNoReasonToRefuse) {
  const Robot robot = load_robot("point");
  const Path edge{Eigen::Vector2d(0, 0), Eigen::Vector2d(1, 0)};
  const Eigen::Vector2d one = Eigen::Vector2d::Ones();
  EXPECT_LT(duration(robot, edge, {one, 1e9 * one, 10.0 * one}),
            1.05 * duration(robot, edge, {one, 2.0 * one, 10.0 * one}));
}

}  // namespace motion_section_test
}  // namespace clearway
