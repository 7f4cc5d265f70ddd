#include "planning/boundary/boundary_plus.hpp"

#include <gtest/gtest.h>

#include <algorithm>

#include "planning/check/path_check.hpp"
#include "planning/planner_table.hpp"
#include "planning/robot_files/load_robot.hpp"
#include "tests/worlds/voxel_scene.hpp"

namespace clearway {
namespace boundary_plus_test {

/// An arm of five joints before a wall with two windows, and configurations with the hand in them.
struct Windows {
  Robot robot = load_robot("arm5");
  Snapshot map;
  ConfigurationSpace space;
  PathCost cost;

  Windows()
      : map(VoxelScene{
            0.05,
            {box_of(0.5, -0.8, 0.0, 0.55, 0.8, 0.3), box_of(0.5, -0.8, 0.7, 0.55, 0.8, 1.1),
             box_of(0.5, -0.8, 0.3, 0.55, -0.55, 0.7), box_of(0.5, -0.1, 0.3, 0.55, 0.1, 0.7),
             box_of(0.5, 0.55, 0.3, 0.55, 0.8, 0.7)},
            {},
            {}}.snapshot()),
        space(robot, map, {.parts = {}, .critical_by_default = false}),
        cost(robot) {}

  /// The hand through the window on that side (-1 right, 1 left), `deep` metres behind the wall.
  Configuration through(int side, double deep, double height) const {
    Configuration near(5);
    near << 0.5 * side, -0.9, 1.6, -0.7, 1.57;
    Eigen::Isometry3d tip = Eigen::Isometry3d::Identity();
    tip.translation() = Eigen::Vector3d(0.52 + deep, 0.33 * side, height);
    const auto q = inverse_kinematics(robot, tip, near, {.position_only = true});
    EXPECT_TRUE(q.has_value());
    return *q;
  }

  PlanResult plan(const std::string& planner, const Configuration& start, const Configuration& goal,
                  const PlannerOptions& options = {}, std::uint64_t seed = 1) const {
    return make_planner(planner, options)->plan({space, cost, start, goal, seed});
  }
};

TEST(BoundaryPlus, GoesFromWindowToWindowWhereThePublishedPlaneFails) {
  const Windows scene;
  int failed = 0;
  for (const double deep : {0.1, 0.15, 0.2}) {
    const Configuration start = scene.through(-1, deep, 0.5), goal = scene.through(1, 0.3 - deep, 0.48);
    ASSERT_TRUE(scene.space.is_free(start)) << scene.space.check(start).sentence();
    ASSERT_TRUE(scene.space.is_free(goal)) << scene.space.check(goal).sentence();
    EXPECT_EQ(scene.plan("constraint", start, goal).status, PlanStatus::no_path);
    failed += scene.plan("boundary", start, goal).status == PlanStatus::no_path;
    const PlanResult result = scene.plan("boundary_plus", start, goal);
    ASSERT_EQ(result.status, PlanStatus::solved) << result.explanation;
    EXPECT_EQ(result.waypoints.front(), start);
    EXPECT_EQ(result.waypoints.back(), goal);
    const PathVerdict verdict =
        check_path(scene.robot, scene.map, scene.space.policies(), 0.0, result.waypoints);
    EXPECT_TRUE(verdict.valid) << verdict.first_contact;
    EXPECT_EQ(result.solved_by, BoundaryPlusStage::hand_over) << result.explanation;
    EXPECT_GT(result.statistics.at("samples"), 0.0);
    EXPECT_GT(result.statistics.at("sampled_share"), 0.0);
  }
  EXPECT_EQ(failed, 3);
}

TEST(BoundaryPlus, StatisticsKeepTheStageAsTheNumberOfItsPlace) {
  std::map<std::string, double> statistics{{"samples", 3.0}};
  EXPECT_FALSE(take_stage(statistics));
  const auto stages = {BoundaryPlusStage::straight_edge, BoundaryPlusStage::local_method,
                       BoundaryPlusStage::plane, BoundaryPlusStage::hand_over};
  double place = 0.0;
  for (const BoundaryPlusStage stage : stages) {
    std::map<std::string, double> in_file = with_stage(statistics, stage);
    EXPECT_EQ(in_file.at("solved_by"), place++) << "as in files: 0 to 3";
    EXPECT_EQ(take_stage(in_file), stage);
    EXPECT_EQ(in_file, statistics);
  }
  EXPECT_EQ(with_stage(statistics, {}), statistics);
  statistics["solved_by"] = 7.0;
  EXPECT_EQ(take_stage(statistics), BoundaryPlusStage::none);
}

TEST(BoundaryPlus, NeedsNoSamplesWhereTheLocalMethodOrAPlaneIsEnough) {
  const Robot robot = load_robot("point");
  const VoxelScene scene{0.05,
                         {box_of(1.5, -1.0, -0.05, 1.6, 1.0, 0.05), box_of(1.0, 0.9, -0.05, 1.6, 1.0, 0.05),
                          box_of(1.0, -1.0, -0.05, 1.6, -0.9, 0.05)},
                         {},
                         {}};
  const ConfigurationSpace space(robot, scene.snapshot(), {.parts = {}, .critical_by_default = false});
  const PathCost cost(robot);
  const Configuration start = Eigen::Vector2d(0.0, 0.0), goal = Eigen::Vector2d(2.5, 0.05);
  const PlanProblem problem{space, cost, start, goal};
  EXPECT_EQ(make_planner("constraint", {})->plan(problem).status, PlanStatus::no_path);
  const PlanResult result = make_planner("boundary_plus", {{"max_samples", "0"}})->plan(problem);
  ASSERT_EQ(result.status, PlanStatus::solved) << result.explanation;
  EXPECT_EQ(result.solved_by, BoundaryPlusStage::plane) << result.explanation;
  EXPECT_EQ(result.statistics.at("samples"), 0.0);
  EXPECT_EQ(result.statistics.at("sampled_share"), 0.0);
  EXPECT_GT(result.statistics.at("steps_boundary"), 0.0);
  ASSERT_EQ(result.origins.size(), result.waypoints.size());
  const auto with_shortcuts = [&](const char* shortcuts) {
    const PlanResult plan =
        make_planner("boundary_plus", {{"max_samples", "0"}, {"shortcuts", shortcuts}, {"smooth", "false"}})
            ->plan(problem);
    return std::count_if(plan.origins.begin(), plan.origins.end(),
                         [](const WaypointOrigin& origin) { return origin.phase == PathPhase::boundary; });
  };
  EXPECT_GT(with_shortcuts("0"), 5) << "what the search found shows where it followed the boundary";
  EXPECT_LT(with_shortcuts("200"), with_shortcuts("0"));
}

TEST(BoundaryPlus, TheSameSeedGivesTheSamePath) {
  const Windows scene;
  const Configuration start = scene.through(-1, 0.1, 0.5), goal = scene.through(1, 0.2, 0.48);
  const PlanResult first = scene.plan("boundary_plus", start, goal, {}, 7);
  const PlanResult again = scene.plan("boundary_plus", start, goal, {}, 7);
  ASSERT_EQ(first.status, PlanStatus::solved);
  EXPECT_EQ(first.waypoints, again.waypoints);
  EXPECT_EQ(first.statistics, again.statistics);
  EXPECT_EQ(first.edges_checked, again.edges_checked);
}

TEST(BoundaryPlus, WithoutTheHandOverItSaysWhatItTriedAndHowFarItCame) {
  const Windows scene;
  const Configuration start = scene.through(-1, 0.1, 0.5), goal = scene.through(1, 0.2, 0.48);
  const PlanResult result = scene.plan("boundary_plus", start, goal, {{"max_samples", "0"}, {"planes", "2"}});
  ASSERT_EQ(result.status, PlanStatus::no_path);
  EXPECT_EQ(result.statistics.at("planes_tried"), 4.0);  // two from each deadlock
  EXPECT_GE(result.statistics.at("deadlocks"), 2.0);
  EXPECT_EQ(result.explored.front(), start);
  for (std::size_t i = 1; i < result.explored.size(); ++i)
    EXPECT_TRUE(scene.space.is_edge_free(result.explored[i - 1], result.explored[i])) << i;
  EXPECT_NE(result.explanation.find("0 samples"), std::string::npos) << result.explanation;
}

TEST(BoundaryPlus, StopsSoonAfterTheDeadline) {
  const Windows scene;
  const Configuration start = scene.through(-1, 0.1, 0.5), goal = scene.through(1, 0.2, 0.48);
  for (const int allowed : {0, 1, 5, 60, 100, 150}) {
    int asked = 0;
    PlanProblem problem{scene.space, scene.cost, start, goal};
    problem.out_of_time = [&] { return asked++ >= allowed; };
    const PlanResult result = make_planner("boundary_plus", {})->plan(problem);
    EXPECT_LE(asked, allowed + 20);  // it asks before every step, sample and arc
    EXPECT_TRUE(result.status == PlanStatus::solved || result.status == PlanStatus::timed_out) << allowed;
  }
}

// A corner that touches what it goes round stays: so of several paths together.
TEST(BoundaryPlus, RoundsTheCornersOfItsPath) {
  const Windows scene;
  const Configuration start = scene.through(-1, 0.1, 0.5), goal = scene.through(1, 0.2, 0.48);
  double sharp_turns = 0.0, smooth_turns = 0.0;
  for (const std::uint64_t seed : {1, 2, 3, 4, 5}) {
    const PlanResult sharp = scene.plan("boundary_plus", start, goal, {{"smooth", "false"}}, seed);
    const PlanResult smooth = scene.plan("boundary_plus", start, goal, {}, seed);
    ASSERT_EQ(smooth.status, PlanStatus::solved);
    EXPECT_LE(smooth.statistics.at("sharpest_turn_rad"), sharp.statistics.at("sharpest_turn_rad") + 1e-9);
    sharp_turns += sharp.statistics.at("sharpest_turn_rad");
    smooth_turns += smooth.statistics.at("sharpest_turn_rad");
  }
  EXPECT_LT(smooth_turns, sharp_turns);
}

TEST(BoundaryPlus, ContradictoryAndUnknownOptionsAreRefused) {
  const auto refusal = [](const PlannerOptions& options) -> std::string {
    try {
      make_planner("boundary_plus", options);
    } catch (const std::invalid_argument& error) {
      return error.what();
    }
    return "accepted";
  };
  EXPECT_EQ(refusal({{"local_steps", "0"}}),
            "boundary_plus: option 'planes' is 4 and 'local_steps' 0: planes begin at deadlocks of the local "
            "method, expected planes 0");
  EXPECT_EQ(refusal({{"local_steps", "0"}, {"planes", "0"}}), "accepted");
  EXPECT_EQ(refusal({{"local_steps", "0"}, {"planes", "0"}, {"max_samples", "0"}}),
            "boundary_plus: options 'local_steps', 'planes' and 'max_samples' are all 0: expected one stage "
            "beside the straight edge");
  EXPECT_EQ(refusal({{"max_step", "0.1"}, {"stride", "2"}}),
            "boundary_plus: options 'max_step' and 'stride' are both given: stride multiplies the automatic "
            "max_step, expected one of them");
  EXPECT_NE(refusal({{"max_steps", "9"}}).find("max_step"), std::string::npos);
  EXPECT_NE(refusal({{"plane", "3"}}).find("planes"), std::string::npos);
  EXPECT_NE(refusal({{"guided_share", "1.5"}}).find("guided_share"), std::string::npos);
}

}  // namespace boundary_plus_test
}  // namespace clearway
