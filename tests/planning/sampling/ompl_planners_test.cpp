#include "planning/sampling/ompl_planners.hpp"

#include <gtest/gtest.h>

#include <thread>

#include "planning/planner_table.hpp"
#include "planning/robot_files/load_robot.hpp"
#include "tests/worlds/voxel_scene.hpp"

namespace clearway {
namespace ompl_planners_test {

using Eigen::Vector2d;

struct Field {
  ConfigurationSpace space;
  PathCost cost;

  Field(const Robot& robot, std::vector<Eigen::AlignedBox3d> boxes)
      : space(robot, VoxelScene{0.05, std::move(boxes), {}, {}}.snapshot(), {.critical_by_default = false}),
        cost(robot) {}

  PlanResult plan(const std::string& planner, const Configuration& start, const Configuration& goal,
                  std::uint64_t seed, const PlannerOptions& options = {}) const {
    return make_planner(planner, options)->plan({space, cost, start, goal, seed});
  }
  bool is_certified(const std::vector<Configuration>& path) const {
    for (std::size_t i = 1; i < path.size(); ++i)
      if (!space.is_edge_free(path[i - 1], path[i])) return false;
    return true;
  }
};

double length(const std::vector<Configuration>& path) {
  double sum = 0.0;
  for (std::size_t i = 1; i < path.size(); ++i) sum += (path[i] - path[i - 1]).norm();
  return sum;
}

const std::vector<Eigen::AlignedBox3d> wall = {box_of(1, -2.0, -0.05, 1.1, 0.9, 0.05)};

class OmplPlannerOf : public testing::TestWithParam<const char*> {};

TEST_P(OmplPlannerOf, PathsAreCertifiedAndTheSameForTheSameSeedOnAnyThread) {
  const Field field(load_robot("point"), wall);
  const Vector2d start(0.0, 0.0), goal(2.5, 0.0);
  const PlannerOptions few{{"max_samples", "1500"}};
  std::vector<std::vector<Configuration>> paths;
  for (std::uint64_t seed = 1; seed <= 5; ++seed) {
    PlanResult first, second, third;
    std::thread other([&] { second = field.plan(GetParam(), start, goal, seed, few); });
    std::thread noise([&] { third = field.plan("est", start, goal, seed + 100, few); });
    first = field.plan(GetParam(), start, goal, seed, few);
    other.join();
    noise.join();
    ASSERT_EQ(first.status, PlanStatus::solved) << first.explanation;
    EXPECT_TRUE(field.is_certified(first.waypoints));
    EXPECT_EQ(first.waypoints.front(), start);
    EXPECT_EQ(first.waypoints.back(), goal);
    EXPECT_EQ(first.waypoints, second.waypoints) << seed;
    EXPECT_NEAR(first.cost, field.cost(first.waypoints), 1e-9);
    paths.push_back(first.waypoints);
  }
  EXPECT_NE(paths[0], paths[1]);
}

TEST_P(OmplPlannerOf, SolvesForAnArm) {
  const Field field(load_robot("puma560"), {box_of(0.35, 0.15, 0.0, 0.5, 0.6, 0.5)});
  const Eigen::VectorXd start = (Eigen::VectorXd(6) << -0.6, -0.8, 0.3, 0.0, 0.4, 0.0).finished();
  const Eigen::VectorXd goal = (Eigen::VectorXd(6) << 1.2, -0.9, 0.5, 0.3, 0.2, 0.4).finished();
  const PlanResult result = field.plan(GetParam(), start, goal, 1, {{"max_samples", "3000"}});
  ASSERT_EQ(result.status, PlanStatus::solved) << result.explanation;
  EXPECT_TRUE(field.is_certified(result.waypoints));
}

TEST_P(OmplPlannerOf, GivesUpOnAnEnclosedGoalAfterItsSamplesOrItsTime) {
  const Field field(load_robot("point"), {box_of(1, -1, -.05, 1.1, 1, .05), box_of(2.9, -1, -.05, 3, 1, .05),
                                          box_of(1, -1, -.05, 3, -.9, .05), box_of(1, .9, -.05, 3, 1, .05)});
  const Vector2d start(0, 0), goal(2, 0);
  const bool improves = std::string_view(GetParam()).ends_with("star");
  if (!improves) {
    const PlanResult result = field.plan(GetParam(), start, goal, 1, {{"max_samples", "500"}});
    EXPECT_EQ(result.status, PlanStatus::no_path);
    EXPECT_NEAR(result.statistics.at("samples"), 500.0, 200.0);
  }
  // What is allowed for a better path ends no search without one.
  const auto planner = make_planner(GetParam(), {{"max_samples", improves ? "100" : "100000000"}});
  PlanProblem problem{field.space, field.cost, start, goal, 1};
  int asked = 0;
  problem.out_of_time = [&asked] { return ++asked > 2000; };
  const PlanResult late = planner->plan(problem);
  EXPECT_EQ(late.status, PlanStatus::timed_out);
  EXPECT_GT(late.statistics.at("samples"), 150.0);
  EXPECT_EQ(field.plan(GetParam(), Vector2d(1.05, 0), goal, 1).status, PlanStatus::start_invalid);
}

TEST_P(OmplPlannerOf, AStartThatIsTheGoalTakesNoSamples) {
  const Field field(load_robot("point"), wall);
  const Vector2d start(0.0, 0.0);
  const PlanResult result = field.plan(GetParam(), start, start, 1, {{"max_samples", "100000000"}});
  EXPECT_EQ(result.status, PlanStatus::solved);
  EXPECT_EQ(result.statistics.at("samples"), 0.0);
}

INSTANTIATE_TEST_SUITE_P(All, OmplPlannerOf, testing::Values("est", "prm", "rrtstar", "bitstar"));

TEST(OmplPlanner, RrtStarAndBitStarSearchUntilTheyHaveAPath) {
  const Field field(load_robot("point"), wall);
  for (const char* name : {"rrtstar", "bitstar", "bitstar_fcl"}) {
    const PlanResult result =
        field.plan(name, Vector2d(0.0, 0.0), Vector2d(2.5, 0.0), 3, {{"max_samples", "1"}});
    EXPECT_EQ(result.status, PlanStatus::solved) << name << ": " << result.explanation;
    EXPECT_GT(result.statistics.at("samples"), 1.0) << name;
  }
}

TEST(OmplPlanner, RrtStarAndBitStarComeNearTheShortestWayAsSamplesGrow) {
  const Field field(load_robot("point"), wall);
  const Vector2d start(0.0, 0.0), goal(2.5, 0.0);
  // Round the end of the wall, (1..1.1, 0.9), at the point robot's radius: two straight lines and some arc.
  const double radius = load_robot("point").bodies.front().shape.radius();
  const double corner = 0.9 + radius;
  const double at_least = (Vector2d(1.0, 0.9) - start).norm() + 0.1 + (goal - Vector2d(1.1, 0.9)).norm();
  const double about = (Vector2d(1.0 - radius, corner) - start).norm() + 0.1 + 2 * radius +
                       (goal - Vector2d(1.1 + radius, corner)).norm();
  for (const char* name : {"rrtstar", "bitstar"}) {
    const auto found = [&](const char* samples) {
      double sum = 0.0;
      for (std::uint64_t seed = 1; seed <= 4; ++seed) {
        const PlanResult result =
            field.plan(name, start, goal, seed, {{"max_samples", samples}, {"shortcuts", "0"}});
        EXPECT_EQ(result.status, PlanStatus::solved) << name;
        EXPECT_GT(length(result.waypoints), at_least);
        sum += length(result.waypoints) / 4;
      }
      return sum;
    };
    const double few = found("400"), many = found("4000");
    EXPECT_LT(many, few) << name;
    EXPECT_LT(many, 1.03 * about) << name;
  }
}

}  // namespace ompl_planners_test
}  // namespace clearway
