#include "datasets/descriptions/suite.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "tests/datasets/complaint.hpp"
#include "tests/worlds/temporary_folder.hpp"

namespace clearway {
namespace suite_test {

const std::string full = R"(
title: Two worlds
seed: 7
time_limit: 2.5
worlds:
  - {name: loaded, map: maps/hall.bt}
  - name: made
    resolution: 0.01
    solids:
      - {name: table, box: [1, 2, 0.1], pose_deg: [0.5, 0, 0.3, 0, 0, 90]}
      - {name: can, cylinder: [0.05, 0.2]}
      - {name: ball, sphere: 0.1, pose: [1, 0, 0, 0, 0, 0]}
    sensors: [[0, 0, 2], [1, 1, 2]]
    sensor_range: 4
    volumes:
      - label: tool
        critical_parts: [tool, load]
        strokes:
          - {balls: [[0, 0, 0, 0.1], [0.1, 0, 0, 0.2]]}
          - {points: [[0, 0, 0], [0, 0, 1], [0, 0.5, 1]], radius: 0.15, spacing: 0.3}
          - {points: [[0, 0, 0], [2, 0, 0]], around: 0.1, radii: [0.1, 0.2], count: 41, seed: 3}
    pockets: [[0.5, 0, 0, 0.08]]
planners:
  - {planner: beam, label: beam k=20, options: {width: 20}}
  - {planner: rrtconnect}
experiments:
  - name: across
    title: Across the table
    paper: 86 steps
    notes: another scene
    robot: puma560
    scale: 0.1
    world: made
    problems:
      - {name: there, start_deg: [0, 90], goals_deg: [[180, 0], [90, -90]]}
      - name: back
        start: [1, 2]
        goals: [[3, 4], [5, 6]]
        loads: [{name: ball, sphere: 0.04, link: tool, pose: [0, 0, 0.15, 0, 0, 0], mass: 0.2, legs: [2]}]
        view: {caption: Mind the gap., cut: {z: 0.5, -x: 0.25}, eye_deg: [60, 50], zoom: 1.4, layers: [painted, others]}
    policies: {default: known_free, tool: painted}
    padding: 0.01
    planners: [{planner: boundary}]
    runs: 3
    time_limit: 1
    plots: [profiles]
    payload: 2.5
    gravity: [0, 9.81, 0]
  - {name: drawn, robot: planar2, generate: {kind: tunnels, count: 12, seed: 5, resolution: 0.05}}
)";

TEST(Suite, EveryKeyIsRead) {
  const Suite suite = parse_suite(full, "folder/two.yaml");
  EXPECT_EQ(suite.name, "two");
  EXPECT_EQ(suite.title, "Two worlds");
  EXPECT_EQ(suite.seed, 7u);
  EXPECT_EQ(suite.time_limit, 2.5);
  ASSERT_EQ(suite.worlds.size(), 2u);
  EXPECT_EQ(suite.worlds[0].map, "folder/maps/hall.bt");
  const SuiteWorld& made = suite.worlds[1];
  EXPECT_TRUE(made.map.empty());
  EXPECT_EQ(made.resolution, 0.01);
  EXPECT_EQ(std::get<CylinderShape>(made.solids.at(1).geometry).length, 0.2);
  EXPECT_TRUE((made.solids[0].map_from_shape.linear() * Eigen::Vector3d::UnitX())
                  .isApprox(Eigen::Vector3d::UnitY(), 1e-12));
  EXPECT_EQ(made.sensors.at(1), Eigen::Vector3d(1, 1, 2));
  EXPECT_EQ(made.sensor_range, 4);
  EXPECT_EQ(made.volumes.at(0).critical_parts, (std::vector<std::string>{"tool", "load"}));
  EXPECT_EQ(made.pockets.at(0).radius, 0.08);
  const SuiteExperiment& across = suite.experiments.at(0);
  EXPECT_EQ(across.title, "Across the table");
  EXPECT_EQ(across.paper, "86 steps");
  EXPECT_EQ(across.notes, "another scene");
  EXPECT_EQ(across.robot, "puma560");
  EXPECT_EQ(across.scale, 0.1);
  EXPECT_NEAR(across.problems.at(0).goals.at(1).at(1), -M_PI / 2, 1e-15);
  EXPECT_EQ(across.problems.at(1).start, (std::vector<double>{1, 2}));
  EXPECT_TRUE(across.problems.at(0).loads.empty());
  const LoadSetup& ball = across.problems.at(1).loads.at(0);
  EXPECT_EQ(std::get<LoadSphere>(ball.shape).radius, 0.04);
  EXPECT_EQ(ball.link_from_load.translation().z(), 0.15);
  EXPECT_EQ(ball.legs, std::vector<int>{2});
  const SuiteView& view = across.problems.at(1).view;
  EXPECT_EQ(view.caption, "Mind the gap.");
  EXPECT_EQ(view.cut, (std::map<std::string, double>{{"z", 0.5}, {"-x", 0.25}}));
  EXPECT_EQ(view.eye_deg, (std::vector<double>{60, 50}));
  EXPECT_EQ(view.zoom, 1.4);
  EXPECT_EQ(view.layers, (std::vector<std::string>{"painted", "others"}));
  EXPECT_EQ(across.policies.at("tool"), "painted");
  EXPECT_EQ(across.padding, 0.01);
  EXPECT_EQ(across.runs, 3);
  EXPECT_EQ(across.time_limit, 1);
  EXPECT_EQ(across.plots, std::vector<std::string>{"profiles"});
  EXPECT_EQ(across.payload, 2.5);
  EXPECT_EQ(across.gravity, Eigen::Vector3d(0, 9.81, 0));
  const SuiteExperiment& drawn = suite.experiments.at(1);
  EXPECT_EQ(drawn.generate->kind, "tunnels");
  EXPECT_EQ(drawn.generate->count, 12);
  EXPECT_EQ(drawn.generate->seed, 5u);
  EXPECT_EQ(drawn.generate->resolution, 0.05);
  EXPECT_FALSE(drawn.time_limit);
  EXPECT_EQ(drawn.payload, 0.0);
  EXPECT_EQ(drawn.gravity, Eigen::Vector3d(0, 0, -9.81));
}

TEST(Suite, StatesOfTheRobotMayStandForNumbers) {
  const auto problem = [](const std::string& ways) {
    return parse_suite(
               "worlds: [{name: w, map: m}]\nplanners: [{planner: beam}]\nexperiments: [{name: e, robot: r, "
               "xacro: {side: left, none: ''}, world: w, problems: [{name: p, " +
                   ways + "}]}]",
               "s.yaml")
        .experiments.at(0);
  };
  const SuiteExperiment named = problem("start: home, goals_deg: [ready, [180, 0]]");
  EXPECT_EQ(named.xacro, (std::map<std::string, std::string>{{"side", "left"}, {"none", ""}}));
  EXPECT_EQ(named.problems[0].start_state, "home");
  EXPECT_EQ(named.problems[0].start, std::vector<double>());
  EXPECT_EQ(named.problems[0].goal_states, (std::vector<std::string>{"ready", ""}));
  EXPECT_EQ(named.problems[0].goals, (std::vector<std::vector<double>>{{}, {M_PI, 0}}));
  EXPECT_EQ(problem("start: [1], goals: [[2]]").problems[0].start_state, "");
  EXPECT_EQ(complaint([&] { problem("start: 1, goals: [[2]]"); }),
            "suite 's.yaml', line 3, experiments[0].problems[0].start: expected a list of numbers, got '1'.");
  EXPECT_EQ(complaint([&] { problem("start: home, goals: [2]"); }),
            "suite 's.yaml', line 3, experiments[0].problems[0].goals: expected a list of numbers, got '2'.");
  EXPECT_EQ(complaint([&] { problem("start: home, goals: ready"); }),
            "suite 's.yaml', line 3, experiments[0].problems[0].goals: expected a list of lists of numbers, "
            "got 'ready'.");
  EXPECT_EQ(complaint([&] { problem("start: [], goals: [ready]"); }),
            "suite 's.yaml', line 3, experiments[0].problems[0].start: expected a number for each joint, or "
            "the name of a state.");
}

TEST(Suite, FilesOfRobotsAreLookedForInItsFolder) {
  const auto robot_of = [](const std::string& robot) {
    return parse_suite("experiments: [{name: e, robot: " + robot +
                           ", generate: {kind: cells, count: 1, seed: 1}, planners: [{planner: beam}]}]",
                       "some/where/s.yaml")
        .experiments.at(0)
        .robot;
  };
  EXPECT_EQ(robot_of("arm.urdf"), "some/where/arm.urdf");
  EXPECT_EQ(robot_of("../arm.yaml"), "some/where/../arm.yaml");
  EXPECT_EQ(robot_of("/robots/arm.urdf"), "/robots/arm.urdf");
  EXPECT_EQ(robot_of("panda"), "panda");
}

TEST(Suite, AnExactWorldIsItsSolidsAlone) {
  const auto world = [](const std::string& more) {
    return "worlds: [{name: w, exact: true, " + more +
           "}]\nplanners: [{planner: beam}]\nexperiments: [{name: e, robot: arm5, world: w, problems: " +
           "[{name: p, start: [0], goals: [[1]]}]}]";
  };
  const Suite suite = parse_suite(world("solids: [{name: s, box: [1, 1, 1]}]"), "s.yaml");
  EXPECT_TRUE(suite.worlds.at(0).is_exact);
  EXPECT_EQ(suite.worlds[0].solids.size(), 1u);
  EXPECT_FALSE(parse_suite(full, "two.yaml").worlds[1].is_exact);
  const auto complaint_of = [&](const std::string& more) {
    return complaint([&] { parse_suite(world(more), "s.yaml"); });
  };
  EXPECT_EQ(complaint_of("resolution: 0.1"),
            "suite 's.yaml', line 1, worlds[0].solids: expected at least one.");
  for (const std::string key : {"sensors: [[0, 0, 1]]", "pockets: [[0, 0, 0, 1]]", "sensor_range: 2"})
    EXPECT_NE(
        complaint_of(key + ", solids: [{name: s, box: [1, 1, 1]}]").find("an exact world is its solids"),
        std::string::npos)
        << key;
}

TEST(Suite, AnExperimentWithoutPlannersTakesTheSuitesAndALabelIsThePlannersName) {
  const Suite suite = parse_suite(full, "two.yaml");
  ASSERT_EQ(suite.experiments.at(1).planners.size(), 2u);
  EXPECT_EQ(suite.experiments[1].planners[0].label, "beam k=20");
  EXPECT_EQ(suite.experiments[1].planners[0].options.at("width"), "20");
  EXPECT_EQ(suite.experiments[1].planners[1].label, "rrtconnect");
  ASSERT_EQ(suite.experiments[0].planners.size(), 1u);
  EXPECT_EQ(suite.experiments[0].planners[0].planner, "boundary");
}

TEST(Suite, AStrokeAlongAPolylineKeepsItsSpacingAndMeetsEveryCorner) {
  const auto stroke = parse_suite(full, "two.yaml").worlds[1].volumes[0].strokes.at(1);
  EXPECT_EQ(stroke.front().center, Eigen::Vector3d(0, 0, 0));
  EXPECT_EQ(stroke.back().center, Eigen::Vector3d(0, 0.5, 1));
  bool corner = false;
  for (size_t i = 0; i < stroke.size(); ++i) {
    EXPECT_EQ(stroke[i].radius, 0.15);
    corner = corner || stroke[i].center == Eigen::Vector3d(0, 0, 1);
    const Eigen::Vector3d before = stroke[i > 0 ? i - 1 : 0].center;
    EXPECT_LE((stroke[i].center - before).norm(), 0.3 + 1e-12);
  }
  EXPECT_TRUE(corner);
}

TEST(Suite, ScatteredSpheresFollowTheirPolylineWithinTheirBounds) {
  const auto stroke = parse_suite(full, "two.yaml").worlds[1].volumes[0].strokes.at(2);
  ASSERT_EQ(stroke.size(), 41u);
  double widest = 0;
  for (size_t i = 0; i < stroke.size(); ++i) {
    const Eigen::Vector3d aside = stroke[i].center - Eigen::Vector3d(0.05 * static_cast<double>(i), 0, 0);
    EXPECT_LE(aside.cwiseAbs().maxCoeff(), 0.1);
    EXPECT_GE(stroke[i].radius, 0.1);
    EXPECT_LE(stroke[i].radius, 0.2);
    widest = std::max(widest, aside.cwiseAbs().maxCoeff());
  }
  EXPECT_GT(widest, 0.08);
}

/// What is said of `full` when `from` is replaced by `to`.
std::string refusal(const std::string& from, const std::string& to) {
  std::string text = full;
  const auto at = text.find(from);
  if (at == std::string::npos) return "'" + from + "' is not in the text";
  text.replace(at, from.size(), to);
  return complaint([&] { parse_suite(text, "s.yaml"); });
}

TEST(Suite, NamesThatWouldShareAFolderAreRefused) {
  std::string text = full;
  text.replace(text.find("name: there"), 11, "name: a b");
  text.replace(text.find("name: back"), 10, "name: a_b");
  EXPECT_NE(complaint([&] { parse_suite(text, "s.yaml"); }).find("'a_b' is given twice"), std::string::npos);
  text.replace(text.find("name: a b"), 9, "name: .a");
  text.replace(text.find("name: a_b"), 9, "name: _.a");
  EXPECT_NE(complaint([&] { parse_suite(text, "s.yaml"); }).find("'_.a' is given twice"), std::string::npos);
}

TEST(Suite, MistakesAreRefusedInOneSentenceWithFileLineAndKey) {
  const std::vector<std::array<std::string, 3>> mistakes = {
      {"runs: 3", "run: 3", "line 44, experiments[0].run: unknown key; did you mean 'runs'?"},
      {"world: made", "world: mad",
       "expected the name of one of the suite's worlds (loaded, made), got 'mad'"},
      {"{kind: tunnels,", "{kind: tunnels, depth: 3,", "experiments[1].generate.depth: unknown key"},
      {"generate: {", "world: made, generate: {", "experiments[1].world: unknown key"},
      {"count: 12", "count: 0", "expected a whole number from 1 to 10000000, got '0'"},
      {"count: 12", "count: 2.5", "expected a whole number from 1 to 10000000, got '2.5'"},
      {"seed: 7", "seed: -4", "seed: expected a whole number from 0 to 18446744073709551615, got '-4'"},
      {"seed: 7", "seed: 18446744073709551616", "expected a whole number from 0 to 18446744073709551615"},
      {"padding: 0.01", "padding: 1e9", "padding: expected a number from 0 to 100, got '1e9'"},
      {"tool: painted", "tool: paint", "expected painted, known_free or not_occupied, got 'paint'"},
      {"name: back", "name: there", "'there' is given twice"},
      {"{planner: rrtconnect}", "{planner: beam, label: beam k=20}", "'beam k=20' is given twice"},
      {"[[0.5, 0, 0, 0.08]]", "[[0.5, 0, 0]]", "expected 4 numbers in each of its lists, got 3"},
      {"[[0.5, 0, 0, 0.08]]", "[[0.5, 0, 0, 0]]", "expected a positive radius"},
      {"sensors: [[0, 0, 2], [1, 1, 2]]", "sensors: []", "at least one sensor that looks at the solids"},
      {"map: maps/hall.bt", "resolution: 0.1", "worlds[0].volumes: expected a map, or sensors or volumes"},
      {"maps/hall.bt", "maps/hall.bt, resolution: 0.1", "worlds[0].resolution: unknown key"},
      {"radius: 0.15, spacing: 0.3", "radius: 0.15, spacing: 1e-9", "spacing: expected"},
      {"radii: [0.1, 0.2]", "radii: [0.2, 0.1]", "the smallest and then the largest radius"},
      {"strokes:\n          - {balls", "strokes:\n          - {ball", "expected either balls, or points"},
      {"payload: 2.5", "payload: -1", "experiments[0].payload: expected a number from 0"},
      {"legs: [2]", "legs: [3]",
       "problems[1].loads[0].legs: expected legs from 1 to 2, one for each goal, got 3"},
      {"sphere: 0.04, ", "", "problems[1].loads[0]"},
      {"{z: 0.5,", "{h: 0.5,", "problems[1].view.cut.h: expected planes of x, y or z, or -x, -y or -z"},
      {"eye_deg: [60, 50], ", "", "problems[1].view.zoom: expected 'eye_deg' beside it"},
      {"[painted, others]", "[paint]", "problems[1].view.layers: expected any of painted, occupied, "},
      {"caption: Mind", "title: Mind", "problems[1].view.title: unknown key"},
      {"gravity: [0, 9.81, 0]", "gravity: [0, 9.81]", "experiments[0].gravity: expected 3 numbers"},
      {"time_limit: 2.5", "time_limit: -1",
       "line 4, time_limit: expected a positive number up to 1000000, got '-1'"},
  };
  for (const auto& [from, to, expected] : mistakes) {
    const std::string sentence = refusal(from, to);
    EXPECT_NE(sentence.find(expected), std::string::npos) << to << "\n  " << sentence;
    EXPECT_EQ(sentence.rfind("suite 's.yaml', line ", 0), 0u) << sentence;
    EXPECT_TRUE(sentence.back() == (sentence.find("did you mean") == std::string::npos ? '.' : '?'))
        << sentence;
  }
}

TEST(Suite, AWorldThatIsAskedForWhereNoneIsDefinedIsRefused) {
  const std::string text =
      "experiments: [{name: a, robot: arm5, world: w, problems: [{name: p, start: [0], goals: [[1]]}]}]";
  EXPECT_NE(complaint([&] {
              parse_suite(text, "s.yaml");
            }).find("experiments[0].world: got 'w', but the suite has no 'worlds'"),
            std::string::npos);
}

TEST(Suite, AListOfNumbersIsAnOptionAsItsTextWouldBeAndASeedMayHave64Bits) {
  std::string text = full;
  text.replace(text.find("width: 20"), 9, "width: 20, step: [0.10, +2e-1]");
  text.replace(text.find("seed: 7"), 7, "seed: 18446744073709551615");
  const Suite suite = parse_suite(text, "s.yaml");
  EXPECT_EQ(suite.experiments[1].planners[0].options.at("step"), "0.10, +2e-1");
  EXPECT_EQ(suite.seed, 18446744073709551615u);
}

TEST(Suite, AFileIsReadAndAMissingOneNamed) {
  const TemporaryFolder folder;
  const auto file = folder / "two.yaml";
  write_file(file, full);
  EXPECT_EQ(load_suite(file).worlds[0].map, folder / "maps/hall.bt");
  const std::string missing = complaint([&] { load_suite(folder / "none.yaml"); });
  EXPECT_NE(missing.find("none.yaml' cannot be read"), std::string::npos);
}

TEST(Suite, ShippedSuitesAreRead) {
  int suites = 0;
  for (const auto& entry :
       std::filesystem::directory_iterator(std::filesystem::path(CLEARWAY_SOURCE_DIR) / "datasets/suites")) {
    if (entry.path().extension() != ".yaml") continue;
    ++suites;
    EXPECT_EQ(load_suite(entry.path()).name, entry.path().stem().string());
  }
  EXPECT_GE(suites, 2);
}

}  // namespace suite_test
}  // namespace clearway
