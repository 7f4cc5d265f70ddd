#include "planning/team/team_check.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "planning/robot_files/load_robot.hpp"
#include "tests/worlds/voxel_scene.hpp"

namespace clearway {
namespace team_check_test {

constexpr double radius = 0.2;  ///< of the point robot's disc

TeamRobot disc(const std::string& name, const VoxelScene& scene = {}) {
  Policies policies;
  policies.critical_by_default = false;
  return {name, std::make_shared<const ConfigurationSpace>(load_robot("point"), scene.snapshot(), policies),
          Eigen::Vector2d::Zero(), Eigen::Vector2d::Zero()};
}

/// Robots that go evenly along straight lines, whatever is in the way.
TeamRun along(const std::vector<std::pair<Eigen::Vector2d, Eigen::Vector2d>>& lines, int steps,
              double period) {
  TeamRun run;
  run.period = period;
  for (const auto& [from, to] : lines) {
    TeamTrace& trace = run.traces.emplace_back();
    for (int k = 0; k <= steps; ++k)
      trace.positions.push_back(from + (to - from) * (static_cast<double>(k) / steps));
  }
  return run;
}

/// Least distance of two points that go evenly along lines in the same time.
double least_distance(const Eigen::Vector2d& apart, const Eigen::Vector2d& motion) {
  const double at = std::clamp(-apart.dot(motion) / motion.squaredNorm(), 0.0, 1.0);
  return (apart + at * motion).norm();
}

TEST(TeamCheck, TheLeastSeparationIsThatOfTheLinesAndNotOfTheSamples) {
  const Team team{{disc("a"), disc("b")}, {}};
  for (const double offset : {0.45, 0.5, 0.7}) {
    // Few samples: the robots pass each other between two of them.
    const Eigen::Vector2d a0(-1.0, 0.0), a1(1.3, 0.0), b0(1.0, offset), b1(-1.0, offset);
    const TeamVerdict verdict = check_team(team, along({{a0, a1}, {b0, b1}}, 3, 1.0), 5.0, 2.0);
    const double truth = least_distance(b0 - a0, (b1 - b0) - (a1 - a0)) - 2.0 * radius;
    EXPECT_NEAR(verdict.least_separation, truth, 1.1e-4) << offset;
    EXPECT_LE(verdict.least_separation, truth + 1e-9);
    EXPECT_TRUE(verdict.is_apart);
    EXPECT_NE(verdict.between.find("a/"), std::string::npos);
    EXPECT_NE(verdict.between.find("b/"), std::string::npos);
  }
}

TEST(TeamCheck, RobotsThatMeetBetweenSamplesAreNotApart) {
  const Team team{{disc("a"), disc("b")}, {}};
  const TeamVerdict verdict =
      check_team(team, along({{{-1, 0}, {1, 0}}, {{1, 0.2}, {-1, 0.2}}}, 1, 1.0), 5.0, 2.0);
  EXPECT_FALSE(verdict.is_apart);
  EXPECT_EQ(verdict.least_separation, 0.0);
}

/// Two arms whose pedestals, which nothing moves, overlap; their distance is nobody's motion.
TEST(TeamCheck, PedestalsThatOverlapTouchAndThoseThatDoNotAreNoSeparation) {
  const auto arm_at = [](const std::string& name, double x) {
    Robot robot = load_robot("planar2");
    Body pedestal = robot.bodies.front();
    pedestal.part = "pedestal";
    pedestal.link = 0;
    pedestal.shape = Shape::sphere(0.5);
    pedestal.link_from_shape = Eigen::Translation3d(0.0, 0.0, -3.0) * Eigen::Isometry3d::Identity();
    pedestal.cover = {{{0.0, 0.0, -3.0}, 0.5}};
    robot.bodies.push_back(pedestal);
    robot.source.clear();
    robot.map_from_base.translation().x() = x;
    Policies policies;
    policies.critical_by_default = false;
    return TeamRobot{name,
                     std::make_shared<const ConfigurationSpace>(robot, VoxelScene{}.snapshot(), policies),
                     Eigen::Vector2d::Zero(), Eigen::Vector2d::Zero()};
  };
  // Each arm points away from the other and turns a little.
  const auto verdict_at = [&](double x) {
    return check_team({{arm_at("a", 0.0), arm_at("b", x)}, {}},
                      along({{{M_PI, 0.0}, {M_PI - 0.1, 0.0}}, {{0.0, 0.0}, {0.1, 0.0}}}, 4, 1.0), 5.0, 9.0);
  };
  const TeamVerdict apart = verdict_at(1.05), overlap = verdict_at(0.95);
  EXPECT_TRUE(apart.is_apart);
  EXPECT_GT(apart.between_robots, 0.1);
  EXPECT_FALSE(overlap.is_apart);
  EXPECT_FALSE(overlap.robots_are_apart);
  EXPECT_EQ(overlap.between_robots, 0.0);
  EXPECT_EQ(overlap.between, "a/pedestal and b/pedestal");
}

TEST(TeamCheck, MovingObstaclesAreSeenAtAnyTime) {
  Team team{{disc("a")}, {}};
  Eigen::Isometry3d from = Eigen::Isometry3d::Identity(), to = from;
  from.translation() = Eigen::Vector3d(0.0, -3.0, 0.0);
  to.translation() = Eigen::Vector3d(0.0, 3.0, 0.0);
  team.obstacles.push_back({"ball", Shape::sphere(0.1), RigidMotion({{0.0, from}, {6.0, to}})});
  const TeamRun run = along({{{-1.0, 0.0}, {-0.5, 0.0}}}, 6, 1.0);
  const TeamVerdict verdict = check_team(team, run, 5.0, 2.0);
  const double truth = least_distance(Eigen::Vector2d(1.0, -3.0), Eigen::Vector2d(-0.5, 6.0)) - radius - 0.1;
  EXPECT_NEAR(verdict.least_separation, truth, 1.1e-4);
  EXPECT_NE(verdict.between.find("ball"), std::string::npos) << verdict.between;
  EXPECT_NEAR(verdict.time, 3.0, 0.3);
}

TEST(TeamCheck, WhatJumpsThroughARobotInNoTimeIsNotApart) {
  Team team{{disc("a")}, {}};
  Eigen::Isometry3d from = Eigen::Isometry3d::Identity(), to = from;
  from.translation() = Eigen::Vector3d(0.0, -3.0, 0.0);
  to.translation() = Eigen::Vector3d(0.0, 3.0, 0.0);
  team.obstacles.push_back(
      {"ball", Shape::sphere(0.1), RigidMotion({{0.0, from}, {0.7, from}, {0.7 + 1e-12, to}})});
  const TeamVerdict verdict = check_team(team, along({{{0.0, 0.0}, {0.0, 0.0}}}, 1, 1.0), 5.0, 1.0);
  EXPECT_FALSE(verdict.is_apart);
  EXPECT_TRUE(verdict.robots_are_apart);
}

TEST(TeamCheck, RobotsThatAreFartherApartThanWhatIsLookedForAreApart) {
  const Team team{{disc("a"), disc("b")}, {}};
  const TeamRun run = along({{{0.0, 0.0}, {0.0, 0.0}}, {{1.0, 0.0}, {1.0, 0.0}}}, 1, 1.0);
  for (const double cap : {1e-12, 1e-5, 1e-3, 0.1}) {
    const TeamVerdict verdict = check_team(team, run, 5.0, cap);
    EXPECT_TRUE(verdict.is_apart) << cap;
    EXPECT_GE(verdict.least_separation, std::min(cap, 9e-4) - 1e-9) << cap;
    EXPECT_EQ(verdict.between, "") << cap;
  }
}

TEST(TeamCheck, TheMapAndTheLimitsOfSpeedAndAccelerationCount) {
  const VoxelScene wall{0.05, {box_of(0.4, -0.5, -0.05, 0.5, 0.5, 0.05)}, {}, {}};
  const Team team{{disc("a", wall)}, {}};
  const TeamVerdict hit = check_team(team, along({{{0.0, 0.0}, {1.0, 0.0}}}, 4, 1.0), 5.0, 1.0);
  EXPECT_FALSE(hit.is_apart);
  EXPECT_NE(hit.contact.find("a: "), std::string::npos) << hit.contact;
  const TeamVerdict free = check_team(team, along({{{0.0, 0.0}, {0.0, 1.0}}}, 4, 0.5), 5.0, 1.0);
  EXPECT_TRUE(free.is_apart) << free.contact;
  EXPECT_NEAR(free.greatest_speed_share, 0.5, 1e-9);         // 0.25 m in 0.5 s, limit 1 m/s
  EXPECT_NEAR(free.greatest_acceleration_share, 0.2, 1e-9);  // from rest to 0.5 m/s in 0.5 s, limit 5 m/s^2
}

}  // namespace team_check_test
}  // namespace clearway
