#include "apps/suites/suite_stages.hpp"

#include <gtest/gtest.h>

#include <filesystem>

#include "mapping/files/map_digest.hpp"
#include "mapping/files/map_file.hpp"
#include "planning/robot_files/load_robot.hpp"
#include "tests/worlds/temporary_folder.hpp"

namespace clearway {
namespace suite_stages_test {

const std::string two_worlds = R"(
worlds:
  - name: painted
    resolution: 0.05
    volumes: [{label: free, strokes: [{balls: [[0.5, 0, 0.5, 0.3]]}]}]
  - {name: loaded, map: MAP}
experiments:
  - name: explicit
    robot: puma560
    world: WORLD
    problems:
      - {name: a, start: [0, 0, 0, 0, 0, 0], goals: [[1, 0, 0, 0, 0, 0], [0, 1, 0, 0, 0, 0]]}
      - {name: b, start: [0, 0, 0, 0, 0, 1], goals: [[1, 0, 0, 0, 0, 0]]}
    policies: {default: known_free, link3: painted}
    planners: [{planner: beam}]
)";

std::string replaced(std::string text, const std::string& from, const std::string& to) {
  return text.replace(text.find(from), from.size(), to);
}

TEST(SuiteStages, AMadeWorldIsOneStageWithItsProblems) {
  const Suite suite = parse_suite(replaced(two_worlds, "WORLD", "painted"), "s.yaml");
  const Robot robot = load_robot("puma560");
  const SuiteStages stages(suite, suite.experiments[0], robot);
  ASSERT_EQ(stages.size(), 1u);
  const SuiteStage stage = stages.make(0);
  EXPECT_EQ(stage.world, "painted");
  EXPECT_EQ(stage.map_file, "");
  EXPECT_EQ(stage.map.resolution(), 0.05);
  EXPECT_EQ(stage.map.state({0.5, 0.0, 0.5}), VoxelState::painted);
  EXPECT_EQ(stage.map.volumes().at(0).critical_parts, robot.critical_parts);
  EXPECT_EQ(stage.digest, map_sha256(stage.map));
  ASSERT_EQ(stage.problems.size(), 2u);
  EXPECT_EQ(stage.problems[0].name, "a");
  EXPECT_EQ(stage.problems[0].goals.at(1)[1], 1.0);
  EXPECT_EQ(stage.problems[1].start[5], 1.0);
}

TEST(SuiteStages, ALoadedWorldIsTheMapOfItsFile) {
  const TemporaryFolder temporary;
  const std::filesystem::path folder = temporary / "map";
  const Suite made = parse_suite(replaced(two_worlds, "WORLD", "painted"), "s.yaml");
  const Robot robot = load_robot("puma560");
  const Snapshot map = SuiteStages(made, made.experiments[0], robot).make(0).map;
  save_map(map, folder);
  const Suite suite =
      parse_suite(replaced(replaced(two_worlds, "WORLD", "loaded"), "MAP", folder.string()), "s.yaml");
  const SuiteStage stage = SuiteStages(suite, suite.experiments[0], robot).make(0);
  EXPECT_EQ(stage.map_file, folder.string());
  EXPECT_EQ(stage.digest, map_sha256(map));
  EXPECT_EQ(stage.map.counts().painted, map.counts().painted);
}

TEST(SuiteStages, WhatDoesNotFitTheRobotIsRefused) {
  const auto refusal = [](const std::string& text, const std::string& robot) -> std::string {
    const Suite suite = parse_suite(text, "s.yaml");
    const Robot loaded = load_robot(robot);
    try {
      SuiteStages(suite, suite.experiments[0], loaded);
    } catch (const std::invalid_argument& error) {
      return error.what();
    }
    return "accepted";
  };
  const std::string good = replaced(two_worlds, "WORLD", "painted");
  EXPECT_EQ(refusal(good, "puma560"), "accepted");
  EXPECT_EQ(refusal(replaced(good, "link3", "panda_hand"), "puma560"),
            "suite 's', experiment 'explicit', field 'policies': robot 'puma560' has no part 'panda_hand'");
  EXPECT_EQ(
      refusal(replaced(good, "[0, 1, 0, 0, 0, 0]", "[0, 1, 0, 0, 0]"), "puma560"),
      "suite 's', experiment 'explicit', problem 'a', field 'goals[1]': got 5 values, expected 6, one for "
      "each joint of robot 'puma560'");
  EXPECT_EQ(refusal(replaced(good, ", link3: painted", ""), "planar2"),
            "suite 's', experiment 'explicit', problem 'a', field 'start': got 6 values, expected 2, one for "
            "each joint of robot 'planar2'");
  const std::string held =
      replaced(good, "0, 1], goals: [[1, 0, 0, 0, 0, 0]]",
               "0, 1], goals: [[1, 0, 0, 0, 0, 0]], loads: [{name: ball, sphere: 0.1, link: tool}]");
  EXPECT_EQ(refusal(held, "puma560"), "accepted");
  EXPECT_EQ(refusal(replaced(held, "link: tool", "link: tol"), "puma560")
                .rfind("suite 's', experiment 'explicit', problem 'b', field 'loads': ", 0),
            0U)
      << refusal(replaced(held, "link: tool", "link: tol"), "puma560");
}

TEST(SuiteStages, StatesOfTheRobotStandForTheirNumbers) {
  Robot robot = load_robot("planar2");
  robot.states = {{"home", {}}, {"half", {}}};
  for (const Joint& joint : robot.joints) robot.states[0].values[joint.name] = 0.25;
  const auto suite = [](const std::string& ways) {
    return parse_suite(
        "worlds: [{name: w, resolution: 0.1, volumes: [{label: v, strokes: [{balls: [[0, 0, 0, 0.3]]}]}]}]\n"
        "planners: [{planner: beam}]\nexperiments: [{name: e, robot: planar2, world: w, problems: [{name: "
        "p, " +
            ways + "}]}]",
        "s.yaml");
  };
  const Suite named = suite("start: home, goals: [[0.5, 0], home]");
  const StageProblem problem = SuiteStages(named, named.experiments[0], robot).make(0).problems.at(0);
  EXPECT_EQ(problem.start, Configuration::Constant(2, 0.25));
  EXPECT_EQ(problem.goals.at(0), Configuration(Eigen::Vector2d(0.5, 0.0)));
  EXPECT_EQ(problem.goals.at(1), Configuration::Constant(2, 0.25));
  const auto refusal = [&](const std::string& ways) -> std::string {
    const Suite wrong = suite(ways);
    try {
      SuiteStages(wrong, wrong.experiments[0], robot);
    } catch (const std::invalid_argument& error) {
      return error.what();
    }
    return "accepted";
  };
  EXPECT_EQ(refusal("start: hom, goals: [home]"),
            "suite 's', experiment 'e', problem 'p', field 'start': robot 'planar2' has no state 'hom', "
            "expected one of home, half");
  EXPECT_NE(refusal("start: home, goals: [half]").find("field 'goals[0]': state 'half' of  says nothing of"),
            std::string::npos)
      << refusal("start: home, goals: [half]");
  robot.states.clear();
  EXPECT_NE(
      refusal("start: home, goals: [half]").find("has no state 'home', expected a number for each joint"),
      std::string::npos);
}

const std::string drawn = R"(
experiments:
  - name: drawn
    robot: puma560
    generate: {kind: KIND, count: 13, seed: 4, resolution: 0.05}
    policies: {default: not_occupied}
    planners: [{planner: beam}]
)";

TEST(SuiteStages, EachTunnelIsAStageAndAShelfHoldsTenProblems) {
  const Robot robot = load_robot("puma560");
  const Suite shelves = parse_suite(replaced(drawn, "KIND", "shelves"), "s.yaml");
  const SuiteStages of_shelves(shelves, shelves.experiments[0], robot);
  ASSERT_EQ(of_shelves.size(), 2u);
  EXPECT_EQ(of_shelves.make(1).problems.size(), 3u);
  EXPECT_THROW(of_shelves.make(2), std::out_of_range);

  Suite tunnels = parse_suite(replaced(drawn, "KIND", "tunnels"), "s.yaml");
  tunnels.experiments[0].policies = {{"tool", "painted"}};
  const SuiteStages of_tunnels(tunnels, tunnels.experiments[0], robot);
  ASSERT_EQ(of_tunnels.size(), 13u);
  const SuiteStage stage = of_tunnels.make(12);
  EXPECT_EQ(stage.world, "tunnel 13");
  EXPECT_EQ(stage.problems.size(), 1u);
  EXPECT_EQ(stage.digest, map_sha256(stage.map));
  EXPECT_EQ(of_tunnels.make(12).digest, stage.digest);
}

TEST(SuiteStages, AnUnknownGeneratorIsRefused) {
  const Suite suite = parse_suite(replaced(drawn, "KIND", "mazes"), "s.yaml");
  const Robot robot = load_robot("puma560");
  try {
    SuiteStages(suite, suite.experiments[0], robot);
    FAIL() << "accepted";
  } catch (const std::invalid_argument& error) {
    EXPECT_STREQ(error.what(),
                 "suite 's', experiment 'drawn', field 'generate': expected one of the kinds tunnels, holes, "
                 "large_holes, shelves, "
                 "shelf, table, ladder, cage, boxes, cells, got 'mazes'");
  }
}

TEST(SuiteStages, ARobotThatDoesNotSuitAGeneratorIsRefusedBeforeAnythingIsDrawn) {
  const auto refusal = [](const std::string& kind, const Robot& robot) -> std::string {
    const Suite suite = parse_suite(replaced(drawn, "KIND", kind), "s.yaml");
    try {
      SuiteStages(suite, suite.experiments[0], robot);
    } catch (const std::invalid_argument& error) {
      return error.what();
    }
    return "accepted";
  };
  const std::string where = "suite 's', experiment 'drawn', field 'generate': ";
  EXPECT_EQ(refusal("cells", load_robot("arm5")),
            where + "cells: robot 'arm5' has 5 joints, expected at least 6 to hold its hand as it likes");
  Robot bare = load_robot("arm6");
  bare.bodies.clear();
  bare.critical_parts.clear();
  for (const char* kind : {"holes", "large_holes", "tunnels"})
    EXPECT_EQ(refusal(kind, bare),
              where + kind + ": robot 'arm6' has no critical part and no body at its tip");
  EXPECT_EQ(refusal("shelf", bare), "accepted");
  EXPECT_EQ(refusal("cells", load_robot("arm6")), "accepted");
}

TEST(SuiteStages, PoliciesAreThoseOfTheExperiment) {
  const Suite suite = parse_suite(replaced(two_worlds, "WORLD", "painted"), "s.yaml");
  const Policies policies = suite_policies(suite, suite.experiments[0], load_robot("puma560"));
  EXPECT_EQ(policies.other, Policy::known_free);
  EXPECT_FALSE(policies.critical_by_default);
  EXPECT_EQ(policies.parts, (std::map<std::string, Policy>{{"link3", Policy::painted}}));
  SuiteExperiment silent = suite.experiments[0];
  silent.policies.clear();
  EXPECT_TRUE(suite_policies(suite, silent, load_robot("puma560")).critical_by_default);
}

}  // namespace suite_stages_test
}  // namespace clearway
