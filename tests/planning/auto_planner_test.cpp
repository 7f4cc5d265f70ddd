#include "planning/auto_planner.hpp"

#include <gtest/gtest.h>

#include <chrono>

#include "planning/check/path_check.hpp"
#include "planning/sampling/rrtconnect.hpp"
#include "tests/worlds/batch_worlds.hpp"

namespace clearway {
namespace auto_planner_test {

PlanResult plan(const ConfigurationSpace& space, const Configuration& start, const Configuration& goal,
                const AutoPlannerOptions& options = {}) {
  int asked = 0;
  return AutoPlanner(options).plan(
      {space, PathCost(space.robot()), start, goal, 3, [asked]() mutable { return ++asked > 2'000; }});
}

TEST(AutoPlanner, SolvesWhatAStraightEdgeDoesNotAndTheIndependentCheckAgrees) {
  int solved = 0, with_corners = 0;
  for (const char* name : {"puma560", "arm5", "panda"}) {
    const Robot robot = load_robot(name);
    const ConfigurationSpace space(robot, worlds::voxels_about(robot, 9), {.critical_by_default = false});
    Random random(19);
    for (int i = 0; i < 6; ++i) {
      Configuration ends[2];
      for (int k = 0; k < 2;) {
        ends[k] = random.configuration(robot);
        k += space.is_free(ends[k]);
      }
      const PlanResult result = plan(space, ends[0], ends[1]);
      if (result.status != PlanStatus::solved) continue;
      ++solved;
      with_corners += result.waypoints.size() > 2;
      EXPECT_EQ(result.waypoints.front(), ends[0]);
      EXPECT_EQ(result.waypoints.back(), ends[1]);
      const PathVerdict check = check_path(robot, space.map(), space.policies(), 0.0, result.waypoints);
      EXPECT_TRUE(check.valid) << name << ": " << check.first_contact;
      const PlanResult again = plan(space, ends[0], ends[1]);
      EXPECT_TRUE(again.status != PlanStatus::solved || again.waypoints == result.waypoints);
    }
  }
  EXPECT_GT(solved, 10);
  EXPECT_GT(with_corners, 1);
}

TEST(AutoPlanner, GoesOnAfterAPlannerThatFailsAndSaysWhoSolvedIt) {
  const Robot robot = load_robot("puma560");
  const ConfigurationSpace space(robot, worlds::voxels_about(robot, 9), {.critical_by_default = false});
  Random random(20);
  int later = 0;
  for (int i = 0; i < 20; ++i) {
    const Configuration start = random.configuration(robot), goal = random.configuration(robot);
    if (!space.is_free(start) || !space.is_free(goal)) continue;
    const PlanResult result = plan(space, start, goal, {.max_samples = 2});  // too few for trees
    if (result.status != PlanStatus::solved) continue;
    const double rounds = result.statistics.at("rounds");
    const bool is_by_trees = rounds == 1.0 || rounds == 3.0;
    EXPECT_EQ(result.explanation.rfind(is_by_trees ? "rrtconnect: " : "b", 0), 0U) << result.explanation;
    later += rounds > 1.0;
  }
  EXPECT_GT(later, 0);
}

TEST(AutoPlanner, ThreadsChangeNothing) {
  int later = 0;
  for (const char* name : {"puma560", "panda"}) {
    const Robot robot = load_robot(name);
    const ConfigurationSpace space(robot, worlds::voxels_about(robot, 9), {.critical_by_default = false});
    const PathCost cost(robot);
    Random random(23);
    for (int i = 0; i < 20; ++i) {
      const Configuration start = random.configuration(robot), goal = random.configuration(robot);
      if (!space.is_free(start) || !space.is_free(goal)) continue;
      const auto with = [&](int threads, int samples) {
        return AutoPlanner({.max_samples = samples, .threads = threads}).plan({space, cost, start, goal, 5});
      };
      for (const int samples : {2, 40}) {
        const PlanResult one = with(1, samples);
        for (const int threads : {2, 5}) {
          const PlanResult many = with(threads, samples);
          ASSERT_EQ(many.status, one.status) << name << " " << i;
          EXPECT_EQ(many.waypoints, one.waypoints);
          EXPECT_EQ(many.explanation, one.explanation);
          EXPECT_EQ(many.edges_checked, one.edges_checked);
          EXPECT_EQ(many.statistics, one.statistics);
        }
        later += one.statistics.at("rounds") > 1.0;
      }
    }
  }
  EXPECT_GT(later, 5);
}

TEST(AutoPlanner, DistinguishesTimeoutFromNoPath) {
  const Robot robot = load_robot("planar2");
  const ConfigurationSpace space(robot, worlds::voxels_about(robot, 9), {.critical_by_default = false});
  const Eigen::Vector2d start(0.0, 0.0), goal(0.5, 0.5);
  const PathCost cost(robot);
  const PlanResult late = AutoPlanner().plan({space, cost, start, goal, 1, [] { return true; }});
  EXPECT_NE(late.status, PlanStatus::no_path);
  const PlanResult wrong = AutoPlanner().plan({space, cost, start, Eigen::Vector2d(0.0, 1e9), 1});
  EXPECT_EQ(wrong.status, PlanStatus::goal_invalid);
}

/// Whose only way is straight: nothing is looked for, nor does the time limit have to end it.
TEST(AutoPlanner, OfASingleJointEndsWhereTheStraightWayDoes) {
  const Robot point = load_robot("point");
  const Robot robot = load_robot({.robot = "point", .fixed = {{point.joints[1].name, 0.0}}});
  ASSERT_EQ(robot.dof(), 1U);
  FreeSpaceMap map({.resolution = 0.02});
  occupy(map, {0.01, 0.01, 0.01});
  const ConfigurationSpace space(robot, map.snapshot(), {.critical_by_default = false});
  const auto at = [](double x) { return Configuration(Configuration::Constant(1, x)); };
  const PlanResult free = plan(space, at(0.5), at(0.8));
  EXPECT_EQ(free.status, PlanStatus::solved) << free.explanation;
  int asked = 0;
  const PlanResult blocked =
      AutoPlanner(AutoPlannerOptions{}).plan({space, PathCost(robot), at(-0.5), at(0.5), 3, [&] {
                                                ++asked;
                                                return false;  // never out of time
                                              }});
  EXPECT_EQ(blocked.status, PlanStatus::no_path);
  EXPECT_NE(blocked.explanation.find("single joint"), std::string::npos) << blocked.explanation;
}

}  // namespace auto_planner_test
}  // namespace clearway
