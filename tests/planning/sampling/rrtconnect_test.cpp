#include "planning/sampling/rrtconnect.hpp"

#include <gtest/gtest.h>

#include <random>

#include "planning/path/shortcut.hpp"
#include "planning/planner_table.hpp"
#include "planning/robot_files/load_robot.hpp"
#include "tests/worlds/painted_tunnel.hpp"
#include "tests/worlds/walled_robot.hpp"

namespace clearway {
namespace rrtconnect_test {

using Eigen::Vector2d;

struct Field : worlds::WalledRobot {
  Field(const Robot& robot, std::vector<Eigen::AlignedBox3d> boxes)
      : WalledRobot(robot, worlds::walls(std::move(boxes))) {}

  PlanResult plan(const Configuration& start, const Configuration& goal, std::uint64_t seed,
                  const PlannerOptions& options = {}) const {
    return WalledRobot::plan("rrtconnect", start, goal, options, seed);
  }
};

const std::vector<Eigen::AlignedBox3d> wall = {box_of(1, -2.0, -0.05, 1.1, 0.9, 0.05)};

double length(const std::vector<Configuration>& path) {
  double sum = 0.0;
  for (std::size_t i = 1; i < path.size(); ++i) sum += (path[i] - path[i - 1]).norm();
  return sum;
}

TEST(RrtConnect, PathsAreCertifiedAndTheSameForTheSameSeed) {
  const Field field(load_robot("point"), wall);
  const Vector2d start(0.0, 0.0), goal(2.5, 0.0);
  for (std::uint64_t seed = 1; seed <= 10; ++seed) {
    const PlanResult first = field.plan(start, goal, seed), second = field.plan(start, goal, seed);
    ASSERT_EQ(first.status, PlanStatus::solved) << first.explanation;
    EXPECT_TRUE(field.is_certified(first.waypoints));
    EXPECT_EQ(first.waypoints.front(), start);
    EXPECT_EQ(first.waypoints.back(), goal);
    EXPECT_EQ(first.waypoints, second.waypoints);
    EXPECT_NEAR(first.cost, field.cost(first.waypoints), 1e-9);
  }
  EXPECT_NE(field.plan(start, goal, 1).waypoints, field.plan(start, goal, 2).waypoints);
}

TEST(RrtConnect, SolvesForAnArm) {
  const Field field(load_robot("puma560"), {box_of(0.35, 0.15, 0.0, 0.5, 0.6, 0.5)});
  const Eigen::VectorXd start = (Eigen::VectorXd(6) << -0.6, -0.8, 0.3, 0.0, 0.4, 0.0).finished();
  const Eigen::VectorXd goal = (Eigen::VectorXd(6) << 1.2, -0.9, 0.5, 0.3, 0.2, 0.4).finished();
  const PlanResult result = field.plan(start, goal, 1);
  ASSERT_EQ(result.status, PlanStatus::solved) << result.explanation;
  EXPECT_TRUE(field.is_certified(result.waypoints));
}

TEST(RrtConnect, FollowsAWayOfTheHandWhereFewSamplesFindNone) {
  const Robot robot = load_robot("puma560");
  const PathCost cost(robot);
  double guided = 0.0, unguided = 0.0;
  for (std::uint64_t seed = 1; seed <= 6; ++seed) {
    const PaintedTunnel tunnel(robot, seed, 4, 0.03);
    const ConfigurationSpace space(robot, tunnel.map);
    const auto plan = [&](double guided_share) {
      const RrtConnect planner({.max_samples = 20000, .guided_share = guided_share});
      return planner.plan({space, cost, tunnel.start, tunnel.goal, 1});
    };
    const PlanResult with = plan(0.3), without = plan(0.0);
    ASSERT_EQ(with.status, PlanStatus::solved) << with.explanation;
    for (std::size_t i = 1; i < with.waypoints.size(); ++i)
      EXPECT_TRUE(space.is_edge_free(with.waypoints[i - 1], with.waypoints[i]));
    EXPECT_EQ(plan(0.3).waypoints, with.waypoints);
    guided += with.statistics.at("samples");
    unguided += without.statistics.at("samples");
  }
  EXPECT_LT(2.0 * guided, unguided);
}

TEST(RrtConnect, GivesUpOnAnEnclosedGoalAfterItsSamples) {
  const Field field(load_robot("point"), {box_of(1, -1, -.05, 1.1, 1, .05), box_of(2.9, -1, -.05, 3, 1, .05),
                                          box_of(1, -1, -.05, 3, -.9, .05), box_of(1, .9, -.05, 3, 1, .05)});
  const PlanResult result = field.plan(Vector2d(0, 0), Vector2d(2, 0), 1, {{"max_samples", "500"}});
  EXPECT_EQ(result.status, PlanStatus::no_path);
  EXPECT_NEAR(result.statistics.at("samples"), 500.0, 1.0);
  EXPECT_EQ(field.plan(Vector2d(1.05, 0), Vector2d(2, 0), 1).status, PlanStatus::start_invalid);
}

TEST(Shortcut, ShortensKeepsTheEndsAndStaysCertified) {
  const Field field(load_robot("point"), wall);
  const std::vector<Configuration> path = {Vector2d(0, 0), Vector2d(0, 2), Vector2d(0.5, 1.8),
                                           Vector2d(2, 2.5), Vector2d(2.5, 0)};
  ASSERT_TRUE(field.is_certified(path));
  double last = 0.0;
  for (const int attempts : {0, 10, 100, 400}) {
    const auto shorter = shortcut(field.space, path, Vector2d::Ones(), 3, attempts);
    EXPECT_TRUE(field.is_certified(shorter));
    EXPECT_EQ(shorter.front(), path.front());
    EXPECT_EQ(shorter.back(), path.back());
    EXPECT_LE(length(shorter), length(path) + 1e-12);
    last = length(shorter);
  }
  EXPECT_LT(last, 0.75 * length(path));
}

TEST(Shortcut, StopsBeforeTheNextEdgeWhenTimeIsOut) {
  const Field field(load_robot("point"), wall);
  const std::vector<Configuration> path = {Vector2d(0, 0), Vector2d(0, 2), Vector2d(0.5, 1.8),
                                           Vector2d(2, 2.5), Vector2d(2.5, 0)};
  EXPECT_EQ(shortcut(field.space, path, Vector2d::Ones(), 3, 100, [] { return true; }), path);
  double before = length(path);
  for (int edges = 1; edges < 40; ++edges) {
    int asked = 0;
    const auto shorter =
        shortcut(field.space, path, Vector2d::Ones(), 3, 100, [&] { return ++asked > edges; });
    EXPECT_TRUE(field.is_certified(shorter));
    EXPECT_LE(length(shorter), before + 1e-12) << edges;  // the same, and one edge more
    before = length(shorter);
  }
}

}  // namespace rrtconnect_test
}  // namespace clearway
