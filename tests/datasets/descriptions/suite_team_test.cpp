#include "datasets/descriptions/suite_team.hpp"

#include <gtest/gtest.h>

#include <numbers>

#include "datasets/descriptions/suite.hpp"

namespace clearway {
namespace suite_team_test {

const std::string robots = R"(
      robots:
        - {name: left, robot: arm5, base_deg: [1, 2, 3, 0, 0, 90], start: [0, 0, 0, 0, 0], goal_deg: [90, 0, 0, 0, 0]}
        - {name: right, robot: puma560, scale: 0.5, payload: 1.5, start: [0, 0, 0, 0, 0, 0], goal: [1, 0, 0, 0, 0, 0]}
)";

std::string suite_with(const std::string& team, const std::string& more = "") {
  return "experiments:\n  - name: e\n    planners: [{planner: boundary}]\n" + more +
         "    teams:\n    - name: pair" + team;
}

TEST(SuiteTeam, RobotsAndMovingThingsAreRead) {
  const Suite suite = parse_suite(
      suite_with(robots + R"(
      moving:
        - shape: {name: ball, sphere: 0.1}
          repeats: true
          path: [{time: 0, pose: [0, 0, 1, 0, 0, 0]}, {time: 2, pose_deg: [1, 0, 1, 0, 0, 180]}, {time: 3, pose: [0, 0, 1, 0, 0, 0]}]
)",
                 "    period: 0.01\n    duration: 7\n    max_acceleration: 3\n    time_limit: 9\n    "
                 "gravity: [1, 0, 0]\n"),
      "test.yaml");
  const SuiteExperiment& experiment = suite.experiments.at(0);
  ASSERT_TRUE(experiment.teams);
  EXPECT_EQ(experiment.teams->period, 0.01);
  EXPECT_EQ(experiment.teams->duration, 7.0);
  EXPECT_EQ(experiment.teams->max_acceleration, 3.0);
  EXPECT_EQ(experiment.time_limit, 9.0);
  EXPECT_EQ(experiment.gravity, Eigen::Vector3d(1, 0, 0));
  const SuiteTeam& team = experiment.teams->teams.at(0);
  ASSERT_EQ(team.robots.size(), 2U);
  EXPECT_EQ(team.robots[0].name, "left");
  ASSERT_TRUE(team.robots[0].map_from_base);
  EXPECT_LT((*team.robots[0].map_from_base * Eigen::Vector3d(1, 0, 0) - Eigen::Vector3d(1, 3, 3)).norm(),
            1e-12);
  EXPECT_NEAR(team.robots[0].goal[0], std::numbers::pi / 2.0, 1e-12);
  EXPECT_FALSE(team.robots[1].map_from_base);
  EXPECT_EQ(team.robots[1].scale, 0.5);
  EXPECT_EQ(team.robots[1].payload, 1.5);
  EXPECT_EQ(team.robots[0].payload, 0.0);
  ASSERT_EQ(team.moving.size(), 1U);
  EXPECT_TRUE(team.moving[0].repeats);
  EXPECT_EQ(std::get<SphereShape>(team.moving[0].shape.geometry).radius, 0.1);
  ASSERT_EQ(team.moving[0].path.size(), 3U);
  EXPECT_NEAR(team.moving[0].path[1].map_from_shape.linear()(0, 0), -1.0, 1e-12);
}

std::string refusal(const std::string& text) {
  try {
    parse_suite(text, "test.yaml");
  } catch (const std::invalid_argument& error) {
    return error.what();
  }
  return "";
}

void expect_refused(const std::string& text, const std::string& part) {
  const std::string sentence = refusal(text);
  EXPECT_NE(sentence.find("test.yaml"), std::string::npos) << sentence;
  EXPECT_NE(sentence.find(part), std::string::npos) << sentence;
}

TEST(SuiteTeam, BadTeamsAreRefusedInASentence) {
  const std::string one = "\n      robots:\n        - {name: a, robot: arm5, start: [0, 0]";
  expect_refused(suite_with(one + "}\n"), "expected where robot 'a' shall go");
  expect_refused(
      suite_with(one + ", goal: [0, 1]}\n        - {name: a, robot: arm5, start: [0], goal: [1]}\n"),
      "'a' is given twice");
  expect_refused(suite_with("\n"), "expected at least one robot");
  expect_refused(suite_with(robots + "      moving: [{shape: {name: left, sphere: 1}, path: [{time: 0, pose: "
                                     "[0, 0, 0, 0, 0, 0]}]}]\n"),
                 "'left' is given twice");
  expect_refused(suite_with(robots + "      moving: [{shape: {name: b, sphere: 1}, path: [{time: 1, pose: "
                                     "[0, 0, 0, 0, 0, 0]}, {time: 1, pose: [0, 0, 0, 0, 0, 0]}]}]\n"),
                 "a time later than the one before");
  const auto moves = [](const std::string& later) {
    return suite_with(
        robots + "      moving: [{shape: {name: b, sphere: 1}, path: [{time: 1, pose: [0, 0, 0, 0, 0, 0]}, " +
        later + "]}]\n");
  };
  expect_refused(moves("{time: 1.0009, pose: [0, 0, 0, 0, 0, 0]}"), "at least 1 ms after the one before");
  expect_refused(moves("{time: 1.5, pose: [501, 0, 0, 0, 0, 0]}"), "no more than 1000 m/s");
  EXPECT_EQ(refusal(moves("{time: 1.001, pose: [0.9, 0, 0, 0, 0, 0]}")), "");
  expect_refused(suite_with(robots + "      moving: [{shape: {name: b, sphere: 1}, path: []}]\n"),
                 "at least one {time, pose}");
  expect_refused(
      suite_with(robots +
                 "      moving: [{shape: {name: b, sphere: 1}, repeats: true, path: [{time: 1, pose: "
                 "[0, 0, 0, 0, 0, 0]}, {time: 2, pose: [1, 0, 0, 0, 0, 0]}]}]\n"),
      "ends where it starts");
  expect_refused(
      suite_with(robots + "      moving: [{shape: {name: b, sphere: 1, pose: [0, 0, 0, 0, 0, 0]}, path: "
                          "[{time: 1, pose: [0, 0, 0, 0, 0, 0]}]}]\n"),
      "expected no pose");
  expect_refused("experiments: [{name: e, planners: [{planner: boundary}], teams: []}]", "at least one team");
  expect_refused(suite_with(robots, "    padding: 0.1\n"), "does not apply to teams");
  expect_refused(suite_with(robots, "    period: 0\n"), "period");
  expect_refused(suite_with(robots, "    scale: 2\n"), "beside each robot of a team");
  expect_refused(suite_with(robots, "    payload: 2\n"), "beside each robot of a team");
  expect_refused(suite_with(robots, "    generate: {kind: crossings, count: 3}\n"), "expected one of");
}

}  // namespace suite_team_test
}  // namespace clearway
