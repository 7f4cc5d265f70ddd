#include "apps/query/query.hpp"

#include <gtest/gtest.h>

#include <map>

#include <functional>
#include <memory>
#include <stdexcept>

#include "datasets/descriptions/setup.hpp"
#include "datasets/yaml/yaml_fields.hpp"
#include "mapping/free_space_map.hpp"
#include "planning/beam/beam.hpp"
#include "planning/plan_and_check.hpp"
#include "planning/robot_files/load_robot.hpp"

namespace clearway {
namespace query_test {

std::string complaint(const std::function<void()>& action) {
  try {
    action();
  } catch (const std::invalid_argument& error) {
    return error.what();
  }
  return "nothing";
}

TEST(Query, AnOptionIsGivenOnceAndWithAValue) {
  EXPECT_EQ(choose_planner_options({"width=5", "step=0.1,0.2"}),
            (PlannerOptions{{"width", "5"}, {"step", "0.1,0.2"}}));
  EXPECT_EQ(complaint([] { choose_planner_options({"width="}); }),
            "--set width=: no value is given, expected width=value");
  EXPECT_EQ(complaint([] {
              choose_planner_options({"width=5", "step=1", "width=6"});
            }),
            "--set: option 'width' is given twice, as '5' and as '6', expected it once");
}

TEST(Query, AWrongPolicyIsRefusedWithItsFlagItsPartAndThoseThatThereAre) {
  const Robot robot = load_robot("point");
  EXPECT_EQ(complaint([&] { choose_policies({"base=free"}, robot); }),
            "--policy base=free: unknown policy 'free': expected painted, known_free or not_occupied");
  EXPECT_EQ(complaint([&] { choose_policies({"free"}, robot); }),
            "--policy free: unknown policy 'free': expected painted, known_free or not_occupied");
}

TEST(Query, ScalesHaveTheSameLimitsInFlagsSettingsSetupsAndSuites) {
  EXPECT_EQ(robot_scales.low, least_scale);
  EXPECT_EQ(robot_scales.high, most_scale);
  const auto load = [](double scale) {
    RobotChoice choice;
    choice.robot = "planar2";
    choice.scale = scale;
    return choose_robot(choice).scale;
  };
  EXPECT_EQ(load(least_scale), parse_setup("robot: {name: planar2, scale: 1e-6}", "s.yaml").robot->scale);
  EXPECT_EQ(complaint([&] { load(0.5 * least_scale); }),
            "--scale: expected a factor from 0.000001 to 1000, got 5e-07");
  EXPECT_NE(complaint([&] { parse_setup("robot: {name: planar2, scale: 5e-7}", "s.yaml"); }), "nothing");
}

TEST(Query, AVolumeForPartsThatTheRobotHasNotIsTold) {
  const Robot robot = load_robot("puma560");
  FreeSpaceMap map({.resolution = 0.05});
  map.add_volume("slip", {"tol"});
  map.add_volume("right", {"tool"});
  map.add_volume("several", {"other", "tool"});
  map.add_volume("any", {});
  map.add_volume("held", {"mug"});
  LegLoad mug;
  mug.load.name = "mug";
  const std::vector<std::string> notes = volume_notes(robot, {mug}, map.snapshot());
  ASSERT_EQ(notes.size(), 1U);
  EXPECT_NE(notes[0].find("volume 'slip' is for tol, and robot 'puma560' has no such part"),
            std::string::npos)
      << notes[0];
}

TEST(Query, AGoalThatABeamComesNearAndDoesNotReachIsReportedBesideTheVerdict) {
  Policies policies;
  policies.critical_by_default = false;
  const Robot robot = load_robot("planar2");
  const ConfigurationSpace space(robot, FreeSpaceMap({.resolution = 0.1}).snapshot(), policies);
  const auto goal_row = [&](bool last_segment) {
    const BeamOptions options{.step = {0.1}, .last_segment = last_segment};
    const Plan plan = plan_and_check({.space = space,
                                      .start = Eigen::Vector2d(0.0, 0.0),
                                      .goals = {Eigen::Vector2d(0.6, 0.31)},
                                      .planner = std::make_shared<Beam>(options)});
    for (const auto& [name, text] : plan_figures(plan)) {
      if (name == "goal 1") return text;
    }
    return std::string();
  };
  EXPECT_EQ(goal_row(true), "");
  EXPECT_NE(goal_row(false).find("check refuses the plan without --accept-goals"), std::string::npos);
}

TEST(Query, LegsWithoutAPathAreNotCountedAsSolvedAndACheckThatWasNotRunIsNoRefusal) {
  const auto rows = [](Plan plan) {
    std::map<std::string, std::string> found;
    for (const auto& [name, text] : plan_figures(plan)) found[name] = text;
    return found;
  };
  const Configuration q = Configuration::Zero(1);
  PlanResult solved, failed;
  solved.status = PlanStatus::solved;
  solved.waypoints = {q, q};
  failed.explanation = "No path found.";
  Plan plan;
  plan.legs = {solved, failed};
  plan.goals = {q, q};
  plan.validation.valid = true;
  plan.legs.back().final_distance = 0.25;
  EXPECT_EQ(rows(plan)["legs"], "1 of 2");
  EXPECT_EQ(rows(plan)["final distance"], "0.25 rad or m from the goal, in joint space");
  EXPECT_EQ(rows(plan)["check"], "valid");
  plan.goals.push_back(q);
  EXPECT_EQ(rows(plan)["legs"], "1 of 3");
  plan.pick.emplace();
  plan.legs = {solved, solved, solved, failed};
  plan.goals = {q, q, q};
  plan.validation = {};
  EXPECT_EQ(rows(plan)["legs"], "3 of 6");
  EXPECT_EQ(rows(plan)["check"], "none, because the plan is not whole");
  EXPECT_FALSE(rows(plan).contains("path clearance"));
  EXPECT_FALSE(rows(plan).contains("tip"));
  plan.tip = "hand";
  EXPECT_EQ(rows(plan)["tip"], "link hand");
  plan.tip = "own tip on hand";
  EXPECT_EQ(rows(plan)["tip"], "own tip on hand");
  plan.validation.first_contact = "edge 0 at 0: hand touches a voxel";
  EXPECT_EQ(rows(plan)["check"], "REFUSED: edge 0 at 0: hand touches a voxel");
}

}  // namespace query_test
}  // namespace clearway
