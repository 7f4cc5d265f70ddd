#include "apps/compare/external_planner.hpp"

#include <gtest/gtest.h>

#include <chrono>
#include <nlohmann/json.hpp>
#include <optional>
#include <set>
#include <string>
#include <thread>

#include "apps/compare/planner_world.hpp"
#include "planning/robot_files/load_robot.hpp"
#include "tests/worlds/voxel_scene.hpp"

namespace clearway {
namespace external_planner_test {

using Json = nlohmann::ordered_json;

Eigen::Vector3d center_of(const Json& cube) {
  return {cube[0].get<double>(), cube[1].get<double>(), cube[2].get<double>()};
}

/// A disc in a map with a wall.
class ExternalPlannerOf : public ::testing::Test {
 protected:
  PlanResult planned(
      const std::string& answer, const std::function<bool()>& out_of_time = [] { return false; }) {
    const ExternalPlanner planner("sh -c 'read world; echo \"{\\\"ready\\\": true}\"; read query; echo \"" +
                                  answer + "\"; read more'");
    planner.prepare(space_);
    return planner.plan({space_, cost_, start_, goal_, 1, out_of_time});
  }

  std::string refusal(const std::string& answer) {
    try {
      planned(answer);
    } catch (const std::runtime_error& error) {
      return error.what();
    }
    return "";
  }

  const ConfigurationSpace space_{
      load_robot("point"),
      VoxelScene{0.05, {box_of(0.9, -0.3, -0.1, 1.0, 0.3, 0.3)}, {}, {}}.snapshot(),
      {{}, Policy::not_occupied, false},
      {.padding = 0.001}};
  const PathCost cost_{space_.robot()};
  const Configuration start_ = Eigen::Vector2d(0.2, 0.0), goal_ = Eigen::Vector2d(0.5, 0.25);
};

TEST_F(ExternalPlannerOf, ReturnsThePathWithItsEndsExact) {
  const PlanResult result = planned("{\\\"path\\\": [[0.2000001, 0], [0.4, 0.1], [0.5, 0.25]]}");
  ASSERT_EQ(result.status, PlanStatus::solved) << result.explanation;
  ASSERT_EQ(result.waypoints.size(), 3u);
  EXPECT_EQ(result.waypoints.front(), start_);
  EXPECT_EQ(result.waypoints[1], Configuration(Eigen::Vector2d(0.4, 0.1)));
  EXPECT_EQ(result.waypoints.back(), goal_);
  EXPECT_EQ(result.search_steps, 2);
}

TEST_F(ExternalPlannerOf, JoinsEndsThatAProgramRoundedByEdges) {
  const PlanResult result = planned("{\\\"path\\\": [[0.2, 0.00001], [0.4, 0.1], [0.5009, 0.25]]}");
  ASSERT_EQ(result.status, PlanStatus::solved) << result.explanation;
  ASSERT_EQ(result.waypoints.size(), 5u);
  EXPECT_EQ(result.waypoints[0], start_);
  EXPECT_EQ(result.waypoints[1], Configuration(Eigen::Vector2d(0.2, 0.00001)));
  EXPECT_EQ(result.waypoints[3], Configuration(Eigen::Vector2d(0.5009, 0.25)));
  EXPECT_EQ(result.waypoints[4], goal_);
  EXPECT_EQ(planned("{\\\"path\\\": [[0.2, 0.0011], [0.5, 0.25]]}").status, PlanStatus::no_path);
  const PlanResult of_one = planned("{\\\"path\\\": [[0.2, 0]]}");
  EXPECT_NE(of_one.explanation.find("from the goal"), std::string::npos) << of_one.explanation;
}

/// A program that reckons in single precision may be a little beyond a limit.
TEST_F(ExternalPlannerOf, DrawsValuesThatRoundingTookBeyondALimitToIt) {
  Robot robot = load_robot("point");
  robot.joints[0].upper = 0.5;
  const ConfigurationSpace space(robot, space_.map(), {{}, Policy::not_occupied, false});
  const auto path_by = [&](const std::string& x) {
    const ExternalPlanner planner(
        "sh -c 'read world; echo \"{\\\"ready\\\": true}\"; read query; echo "
        "\"{\\\"path\\\": [[0.2, 0], [" +
        x + ", 0.1], [0.5, 0.25]]}\"; read more'");
    return planner.plan({space, cost_, start_, goal_, 1}).waypoints;
  };
  EXPECT_EQ(path_by("0.50000003")[1][0], 0.5);
  EXPECT_EQ(path_by("0.500001")[1][0], 0.500001);  // the check refuses it
}

/// The check goes along each turn, and would take longer than a run may.
TEST_F(ExternalPlannerOf, TakesNoPathThatWindsAJointBeyondMeasure) {
  Robot robot = load_robot("planar2");
  robot.joints[1].lower = -INFINITY;
  robot.joints[1].upper = INFINITY;
  const ConfigurationSpace space(robot, Snapshot(), {{}, Policy::not_occupied, false});
  const PathCost cost(space.robot());
  const auto answer_to = [&](const std::string& turned) {
    const ExternalPlanner planner(
        "sh -c 'read world; echo \"{\\\"ready\\\": true}\"; read query; echo "
        "\"{\\\"path\\\": [[0, 0], [0, " +
        turned + "], [0.1, 0]]}\"; read more'");
    return planner.plan({space, cost, Eigen::Vector2d::Zero(), Eigen::Vector2d(0.1, 0.0), 1});
  };
  EXPECT_EQ(answer_to("-600").status, PlanStatus::solved);
  const PlanResult wound = answer_to("-10000");
  EXPECT_EQ(wound.status, PlanStatus::no_path);
  EXPECT_EQ(wound.explanation,
            "The program's path winds joint elbow by 3183 turns in all: expected at most 200.");
}

TEST_F(ExternalPlannerOf, TellsWhyThereIsNoPath) {
  EXPECT_EQ(planned("{\\\"failed\\\": \\\"no luck\\\"}").explanation, "no luck");
  const PlanResult elsewhere = planned("{\\\"path\\\": [[0.2, 0], [0.6, 0.25]]}");
  EXPECT_EQ(elsewhere.status, PlanStatus::no_path);
  EXPECT_NE(elsewhere.explanation.find("ends 0.1 (rad or m, of one joint) from the goal"), std::string::npos)
      << elsewhere.explanation;
  int asked = 0;
  const ExternalPlanner deaf("sh -c 'read world; echo \"{\\\"ready\\\": true}\"; sleep 1000'");
  EXPECT_EQ(deaf.plan({space_, cost_, start_, goal_, 1, [&] { return ++asked > 3; }}).status,
            PlanStatus::timed_out);
}

/// Of the program alone; what reads and costs its answer is ours.
TEST_F(ExternalPlannerOf, TakesTheTimeFromQueryToAnswerAndNoLaterOne) {
  const ExternalPlanner slow(
      "sh -c 'read world; echo \"{\\\"ready\\\": true}\"; while read query; do sleep 0.3; "
      "echo \"{\\\"path\\\": [[0.2, 0], [0.5, 0.25]]}\"; done'");
  slow.prepare(space_);
  const PlanResult in_time = slow.plan({space_, cost_, start_, goal_, 1});
  EXPECT_EQ(in_time.status, PlanStatus::solved);
  ASSERT_TRUE(in_time.process_time);
  EXPECT_GE(in_time.process_time->wall, 0.3);
  EXPECT_LT(in_time.process_time->cpu, 0.3);
  const PlanResult late = slow.plan({space_, cost_, start_, goal_, 1, [] { return false; }, 0.1});
  EXPECT_EQ(late.status, PlanStatus::timed_out);
  EXPECT_EQ(late.explanation, "The program answered after its time limit.");
  EXPECT_TRUE(late.waypoints.empty());
  EXPECT_EQ(slow.plan({space_, cost_, start_, goal_, 1}).status, PlanStatus::solved);
}

/// Problems that follow each other in one process may have their spaces in one place.
TEST_F(ExternalPlannerOf, ASpaceInThePlaceOfAnotherIsAWorldOfItsOwn) {
  const ExternalPlanner tells(  // its process, of which each world has one
      "while read line; do case \"$line\" in '{\"world\"'*) echo '{\"ready\": true}';; "
      "*) echo '{\"failed\": \"by '$$'\"}';; esac; done");
  std::optional<ConfigurationSpace> space;
  std::set<std::string> processes;
  for (std::size_t worlds = 1; worlds <= 3; ++worlds) {
    space.emplace(load_robot("point"), space_.map(), Policies{{}, Policy::not_occupied, false});
    for (int query = 0; query < 2; ++query)
      processes.insert(tells.plan({*space, cost_, start_, goal_, 1, [] { return false; }}).explanation);
    EXPECT_EQ(processes.size(), worlds);
  }
}

TEST_F(ExternalPlannerOf, RefusesAnswersThatAreNone) {
  for (const auto& [answer, expected] : {std::pair("hello", "one JSON object"),
                                         {"[1, 2]", "one JSON object"},
                                         {"{}", "'path' or 'failed'"},
                                         {"{\\\"path\\\": []}", "2 finite numbers"},
                                         {"{\\\"path\\\": [[1, 2, 3]]}", "2 finite numbers"},
                                         {"{\\\"path\\\": [[1, null]]}", "2 finite numbers"}})
    EXPECT_NE(refusal(answer).find(expected), std::string::npos) << answer << ": " << refusal(answer);
  EXPECT_THROW(ExternalPlanner(" "), std::invalid_argument);
}

TEST_F(ExternalPlannerOf, RefusesALineThatAnswersNoQuestionOrTwoInOne) {
  EXPECT_NE(
      refusal("{\\\"path\\\": [[0.2, 0], [0.5, 0.25]], \\\"path\\\": [[0.2, 0], [0.4, 0.1], [0.5, 0.25]]}")
          .find("each key once"),
      std::string::npos);
  const std::string path = "echo \"{\\\"path\\\": [[0.2, 0], [0.5, 0.25]]}\"";
  const ExternalPlanner planner("sh -c 'read world; echo \"{\\\"ready\\\": true}\"; read query; " + path +
                                "; " + path + "; read more; " + path + "; read end'");
  planner.prepare(space_);
  const auto ask = [&] { return planner.plan({space_, cost_, start_, goal_, 1, [] { return false; }}); };
  EXPECT_EQ(ask().status, PlanStatus::solved);
  std::this_thread::sleep_for(std::chrono::milliseconds(300));
  try {
    ask();
    FAIL() << "the second line is to no question";
  } catch (const std::runtime_error& error) {
    EXPECT_NE(std::string(error.what()).find("one line for each question"), std::string::npos)
        << error.what();
  }
}

TEST_F(ExternalPlannerOf, AsksNobodyForTheWayFromAPlaceToItself) {
  const ExternalPlanner none("/nowhere");
  EXPECT_EQ(none.plan({space_, cost_, start_, start_, 1}).status, PlanStatus::solved);
}

/// What blocks a body is among the cubes that the world lists, and nothing else is.
TEST_F(ExternalPlannerOf, IsToldTheVoxelsThatBlockAndThoseThatDoNot) {
  const Json world = planner_world(space_);
  ASSERT_EQ(world["regions"].size(), 1u);
  const Json& region = world["regions"][0];
  EXPECT_EQ(region["policy"], "not_occupied");
  double volume = 0.0;
  for (const Json& cube : region["blocked"]) {
    const double edge = cube[3];
    volume += edge * edge * edge;
    EXPECT_EQ(space_.map().state(center_of(cube)), VoxelState::occupied);
  }
  EXPECT_NEAR(volume, 2 * 12 * 8 * 0.05 * 0.05 * 0.05, 1e-9);
  VoxelScene scene{0.05, {}, {{{0.0, 0.0, 0.0}, 0.3}}, {}};
  const ConfigurationSpace inside(load_robot("point"), scene.snapshot(), {}, {});
  const Json free = planner_world(inside)["regions"][0];
  EXPECT_EQ(free["policy"], "painted");
  ASSERT_GT(free["free"].size(), 10u);
  for (const Json& cube : free["free"]) EXPECT_EQ(inside.map().state(center_of(cube)), VoxelState::painted);
}

TEST_F(ExternalPlannerOf, IsToldARobotWhoseSpheresHoldItsBodies) {
  const Robot arm = load_robot("arm6");
  const ConfigurationSpace space(arm, Snapshot(), {}, {});
  const Json robot = planner_world(space)["robot"];
  EXPECT_EQ(robot["joints"].size(), arm.dof());
  ASSERT_EQ(robot["links"].size(), arm.links.size());
  EXPECT_EQ(robot["links"][1]["parent_from_link"].size(), 4u);
  ASSERT_EQ(robot["bodies"].size(), arm.bodies.size());
  for (std::size_t i = 0; i < arm.bodies.size(); ++i)
    EXPECT_EQ(robot["bodies"][i]["spheres"].size(), arm.bodies[i].cover.size());
}

/// What a program may read: the URDF, not the settings that name it, and what xacro made is in no file.
TEST_F(ExternalPlannerOf, IsToldTheUrdfAndWhereHeldJointsStand) {
  Robot panda = load_robot(RobotRequest{.robot = "panda", .fixed = {{"joint7", 0.3}}});
  const auto told = [](const Robot& robot) {
    return planner_world(ConfigurationSpace(robot, Snapshot(), {}, {}))["robot"];
  };
  const Json robot = told(panda);
  EXPECT_TRUE(robot["urdf"].get<std::string>().ends_with("panda.urdf")) << robot["urdf"];
  EXPECT_EQ(robot["held"]["joint7"], 0.3) << robot["held"];
  panda.source = "panda.urdf.xacro";
  EXPECT_TRUE(told(panda)["urdf"].is_null());
}

}  // namespace external_planner_test
}  // namespace clearway
