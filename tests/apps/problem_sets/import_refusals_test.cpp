// What `clearway import` refuses, each in one sentence.
#include <gtest/gtest.h>

#include <algorithm>
#include <set>

#include "datasets/descriptions/suite.hpp"
#include "planning/robot_files/load_robot.hpp"
#include "tests/apps/problem_sets/import_fixture.hpp"

namespace clearway {
namespace import_test {

TEST_F(Import, ARequestForAnotherRobotIsRefusedWithTheJointThatItNames) {
  const std::string scene = folder_.write("a.yaml", "world: {collision_objects: []}");
  const std::string request = folder_.write(
      "b.yaml", "goal_constraints: [{joint_constraints: [{joint_name: shoulder_1, position: 0}]}]");
  const CommandRun run = import("mbm", {scene, request});
  EXPECT_EQ(run.status, exit_bad_input);
  EXPECT_NE(
      run.log.find("names joint 'shoulder_1', which robot 'arm' does not have, did you mean 'shoulder'?"),
      std::string::npos)
      << run.log;
}

TEST_F(Import, RequestsWithoutAGoalAreNotSaidToBeForAnotherRobot) {
  const std::string scene = folder_.write("a.yaml", "world: {collision_objects: []}");
  const std::string request =
      folder_.write("b.yaml", "goal_constraints: [{orientation_constraints: [{link_name: lower}]}]");
  const CommandRun run = import("mbm", {scene, request});
  EXPECT_EQ(run.status, exit_bad_input);
  EXPECT_EQ(run.log,
            "clearway: import: no request has a goal of joint values or of a pose (b.yaml: a goal of an "
            "orientation alone), expected at least one\n");
}

/// As every other joint that a start rounds; beyond that the sentence names the start, not a flag.
TEST_F(Import, AStartMayRoundAJointThatSettingsHoldBeyondItsLimitAndNoMore) {
  folder_.write("arm.yaml", "urdf: arm.urdf\nfixed: {grip: 0.01}\n");
  const std::string scene = folder_.write("a.yaml", "world: {collision_objects: []}");
  const auto import_at = [&](const std::string& grip, const Arguments& more = {}) {
    std::string request = arm_request;
    request.replace(request.find("[0.02,"), 6, "[" + grip + ",");
    std::filesystem::remove_all(folder_ / "out");
    return import("mbm", {scene, folder_.write("b.yaml", request)}, more);
  };
  const auto fixed = [&] { return load_suite(folder_.path() / "out/suite.yaml").experiments.at(0).fixed; };
  for (const auto& [start, limit] : {std::pair{"0.1000003", 0.1}, std::pair{"-1e-7", 0.0}}) {
    const CommandRun run = import_at(start);
    ASSERT_EQ(run.status, exit_done) << run.log;
    EXPECT_EQ(fixed(), (std::map<std::string, double>{{"grip", limit}}));
  }
  ASSERT_EQ(import_at("0.5", {"--fix", "grip=0.03"}).status, exit_done);
  EXPECT_EQ(fixed(), (std::map<std::string, double>{{"grip", 0.03}}));
  const CommandRun beyond = import_at("0.5");
  EXPECT_EQ(beyond.status, exit_bad_input);
  EXPECT_NE(beyond.log.find("start: joint 'grip' is at 0.5, expected a number within its limits 0 to 0.1"),
            std::string::npos)
      << beyond.log;
  EXPECT_EQ(beyond.log.find("--fix"), std::string::npos) << beyond.log;
}

/// As MoveIt's benchmark suite writes a scene in which nothing stands.
TEST_F(Import, ASceneWithoutAWorldIsAnEmptyOne) {
  const CommandRun run =
      import("mbm", {folder_.write("empty.yaml", "name: \"\"\n"), folder_.write("b.yaml", arm_request)});
  ASSERT_EQ(run.status, exit_done) << run.log;
  EXPECT_EQ(map("empty").counts().occupied, 0U);
  EXPECT_EQ(compared(folder_)["valid"], 1);
}

TEST_F(Import, WhatIsWrongIsReportedInOneSentence) {
  const auto expect_refused = [&](const std::string& kind, const std::string& name, const std::string& text,
                                  const std::string& expected) {
    const CommandRun run = import(kind, {folder_.write(name, text)});
    EXPECT_EQ(run.status, exit_bad_input) << name;
    EXPECT_TRUE(run.complains_in_one_sentence()) << run.log;
    EXPECT_NE(run.log.find(expected), std::string::npos) << run.log;
    EXPECT_FALSE(std::filesystem::exists(folder_.path() / "out/import.json"));
  };
  const std::string object = "world: {collision_objects: [{id: a, ";
  expect_refused("mbm", "a.yaml", "a: [", "a.yaml");
  expect_refused(
      "mbm", "a.yaml", "x: 1",
      "no file is a scene, expected at least one (a.yaml: neither a scene with 'world' nor a request "
      "with 'goal_constraints')");
  expect_refused("mbm", "a.yaml",
                 object + "primitives: [{type: torus, dimensions: [1]}], primitive_poses: [{}]}]}", "torus");
  expect_refused("mbm", "a.yaml", object + "primitives: [{type: box, dimensions: [1, 2]}]}]}", "dimensions");
  expect_refused("mbm", "a.yaml", object + "primitives: [{type: sphere, dimensions: [-1]}]}]}", "dimensions");
  expect_refused(
      "mbm", "a.yaml",
      object +
          "primitives: [{type: sphere, dimensions: [1]}], primitive_poses: [{orientation: [1, 1, 1, 1]}]}]}",
      "expected a unit quaternion x, y, z, w, got one of norm 2");
  expect_refused("mbm", "a.yaml", object + "meshes: [{resource: no.stl}]}]}", "no.stl");
  const std::string triangle = object + "meshes: [{vertices: [[0, 0, 0], [1, 0, 0], {x: 0, y: 1, z: 0}], ";
  for (const auto& [triangles, expected] :
       {std::pair{"[0, 1]", "expected 3 numbers for each row, got 2"},
        std::pair{"[[0, 1]]", "expected 3 numbers in each of its rows, got 2"},
        std::pair{"[[0, 1, 3]]", "expected a number from 0 to 2, got '3'"},
        std::pair{"[[0, 1, 0.5]]", "expected whole numbers"},
        std::pair{"[{indices: [0, 1, 2]}]", "expected 'vertex_indices' in each of its maps"},
        std::pair{"[[0, 1, 2], 0]", "expected a list of numbers, got '0'"},
        std::pair{"[]", "expected at least one"}})
    expect_refused("mbm", "a.yaml", triangle + "triangles: " + triangles + "}]}]}", expected);
  expect_refused("mbm", "a.yaml", object + "meshes: [{vertices: [], triangles: []}]}]}",
                 "expected at least one");
  expect_refused("mbm", "a.yaml", arm_request, "no file is a scene");
  expect_refused("scene", "a.scene", "name\n* a\n1\nbox\n1 1\n.\n",
                 "line 6: expected a size in metres, got '.'");
  expect_refused("scene", "a.scene", "name\n* a\n1\nbox\n1 1 1\n0 0 0\n0 0 0 1\n0 0 0 0\n",
                 "expected '*' before an object");
  expect_refused("scene", "a.scene", "name\n* a\n1e9\n", "number of shapes");
  expect_refused("json", "a.json",
                 "{\"problems\": {\"a\": [{\"start\": [0], \"goals\": [[1]], \"box\": [{}]}]}}", "position");
  const auto box_with = [](const std::string& more) {
    return "{\"problems\": {\"a\": [{\"start\": [0, 0, 0], \"goals\": [[1, 0, 0]], \"box\": [{\"position\": "
           "[1, "
           "0, 0], \"half_extents\": [0.2, 0.02, 0.02], " +
           more + "}]}]}}";
  };
  expect_refused("json", "a.json", box_with("\"orientation\": [0, 0, 0.7071, 0.7071]"),
                 "box[0].orientation': expected 'orientation_quat_xyzw', 'orientation_quat_wxyz' or "
                 "'orientation_euler_xyz' in its place");
  for (const char* key : {"rotation", "Quat", "pose", "size", "yaw", "height", "half_extents_m", "radius"})
    expect_refused("json", "a.json", box_with("\"" + std::string(key) + "\": 1"), "expected no such key");
  expect_refused("json", "a.json", box_with("\"orientation_quat_wxyz\": [1, 1, 0, 0]"),
                 "expected a unit quaternion w, x, y, z, got one of norm 1.414");
  expect_refused("json", "a.json", box_with("\"rpy\": [0, 0, 1], \"quaternion_xyzw\": [0, 0, 0, 1]"),
                 "expected the same turn as 'quaternion_xyzw'");
  for (const char* key : {"rpy", "orientation_euler_xyz"})
    expect_refused("json", "a.json", box_with("\"" + std::string(key) + "\": [0, 0, 90]"),
                   std::string(key) + "': expected angles in radians, each within a whole turn");
  expect_refused("json", "a.json", "{\"problems\": 3}", "problems");
  expect_refused("json", "a.json", "{\"problems\": {}}", "the files hold no problem, expected at least one");
  expect_refused("json", "a.json", "{\"problems\": {\"a\": [{\"start\": [0], \"goals\": []}]}}",
                 "all problems are left out (a 1: it has no goal)");
  expect_refused(
      "json", "a.json",
      "{\"problems\": {\"a\": [{\"start\": [0, 0, 0], \"start\": [1, 0, 0], \"goals\": [[1, 0, 0]]}]}}",
      "has key 'start' twice in one object, expected it once");
  expect_refused("json", "a.json", "[", "not valid JSON");
}

/// Files of a suite have simple names: whose they are is on record, and the page has the group's own.
/// Planners cannot solve what no robot can do: of a set in degrees, or for another robot, that is said first.
TEST_F(Import, StartsAndGoalsBeyondLimitsAreLeftOut) {
  robot_ = "panda";
  const std::string start = "[0, -0.3, 0, -2.2, 0, 2, 0.785]", goal = "[0.5, -0.3, 0, -2.2, 0, 2, 0.785]",
                    barely = "[2.8976, -0.3, 0, -2.2, 0, 2, 0.785]",
                    degrees = "[30, -20, 0, -120, 0, 115, 45]", beyond = "[3, -0.3, 0, -2.2, 0, 2, 0.785]";
  const auto problem = [&](const std::string& from, const std::string& goals) {
    return "{\"start\": " + from + ", \"goals\": [" + goals + "]}";
  };
  const std::string file =
      folder_.write("set.json", "{\"problems\": {\"a\": [" + problem(start, beyond + ", " + goal) + ", " +
                                    problem(start, degrees) + ", " + problem(beyond, goal) + ", " +
                                    problem(start, barely) + "]}}");
  const CommandRun run = import("json", {file}, {"--json"});
  ASSERT_EQ(run.status, exit_done) << run.log;
  const Json said = Json::parse(run.out);
  EXPECT_EQ(said["problems"], 2);
  ASSERT_EQ(said["left_out"].size(), 3U) << said["left_out"];
  EXPECT_NE(said["left_out"].dump().find("are these degrees?"), std::string::npos) << said["left_out"];
  const Suite suite = load_suite(folder_ / "out/suite.yaml");
  ASSERT_EQ(suite.experiments[0].problems.size(), 2U);
  EXPECT_DOUBLE_EQ(suite.experiments[0].problems[0].goals[0][0], 0.5);
  EXPECT_NEAR(suite.experiments[0].problems[1].goals[0][0], load_robot("panda").joints[0].upper, 1e-12);
}

TEST_F(Import, GroupsAndProblemsKeepTheirNamesOnRecordWhateverFilesAreCalled) {
  const std::string problem = "[{\"start\": [0, 0, 0.01], \"goals\": [[0.5, 0, 0.01]]}]";
  const std::string sets =
      folder_.write("a.json", "{\"problems\": {\"a/b\": " + problem + ", \"a_b\": " + problem +
                                  ", \"ü\\n\": " + problem + "}}");
  ASSERT_EQ(import("json", {sets}).status, exit_done);
  const Json record = Json::parse(read_file(folder_.file("out/import.json")));
  const Suite suite = load_suite(folder_.path() / "out/suite.yaml");
  std::set<std::string> places, titles;
  ASSERT_EQ(record["problems"].size(), 3U);
  for (const Json& entry : record["problems"]) {
    const Json& place = entry["in_suite"];
    places.insert(place["experiment"]);
    const auto experiment =
        std::find_if(suite.experiments.begin(), suite.experiments.end(),
                     [&](const SuiteExperiment& each) { return each.name == place["experiment"]; });
    ASSERT_NE(experiment, suite.experiments.end());
    ASSERT_EQ(experiment->problems.size(), 1U);
    EXPECT_EQ(experiment->problems[0].name, place["problem"]);
    titles.insert(experiment->title);
    const std::string name = entry["name"];
    EXPECT_TRUE(name.starts_with(experiment->title.substr(0, 2))) << name << ", " << experiment->title;
  }
  EXPECT_EQ(places.size(), 3U);
  EXPECT_EQ(titles.size(), 3U);
}

/// A folder of MotionBenchMaker: config.yaml, and scenes twice, as solids and as a sensor saw them.
TEST_F(Import, ScenesOfOneNumberAreNamedAndOtherFilesAreSaidToBeLeftOut) {
  const std::string scene = folder_.write("scene0001.yaml", "world: {collision_objects: []}");
  const std::string sensed = folder_.write("scene_sensed0001.yaml", "world: {collision_objects: []}");
  const std::string config = folder_.write("config.yaml", "robot: {name: arm}\nsamples: 100\n");
  const std::string request = folder_.write("request0001.yaml", arm_request);
  const std::string other = folder_.write("table0001.yaml", "world: {collision_objects: []}");
  const CommandRun both = import("mbm", {config, request, other, sensed});
  EXPECT_EQ(both.status, exit_bad_input);
  EXPECT_TRUE(both.complains_in_one_sentence()) << both.log;
  EXPECT_NE(both.log.find("2 scenes have names that end in its number, "), std::string::npos) << both.log;
  EXPECT_NE(both.log.find("/table0001', '"), std::string::npos) << both.log;
  EXPECT_NE(both.log.find("/scene_sensed0001', expected one"), std::string::npos) << both.log;
  const CommandRun folder = import("mbm", {config, request, sensed, scene});  // as the shell has DIR/*.yaml
  EXPECT_EQ(folder.status, exit_done) << folder.log;
  const Json made = Json::parse(read_file(folder_.file("out/import.json")));
  EXPECT_EQ(made["problems"][0]["world"], "scene0001") << made;
  std::filesystem::remove_all(folder_.path() / "out");
  const CommandRun one = import("mbm", {config, request, scene});
  EXPECT_EQ(one.status, exit_done) << one.log;
  EXPECT_NE(one.out.find("config.yaml: neither a scene with 'world' nor a request with 'goal_constraints'"),
            std::string::npos)
      << one.out;
}

TEST_F(Import, ScenesOfOneNumberInSeveralFoldersGoWithTheRequestsBesideThem) {
  Arguments files;
  for (const char* folder : {"shelf", "table"}) {
    std::filesystem::create_directories(folder_.path() / folder);
    for (const char* name : {"scene0001", "scene_sensed0001"})
      files.push_back(
          folder_.write(std::string(folder) + "/" + name + ".yaml", "world: {collision_objects: []}"));
    files.push_back(folder_.write(std::string(folder) + "/request0001.yaml", arm_request));
  }
  const CommandRun run = import("mbm", files);
  ASSERT_EQ(run.status, exit_done) << run.log;
  const Json made = Json::parse(read_file(folder_.file("out/import.json")));
  EXPECT_EQ(made["problems"][0]["world"], "shelf/scene0001") << made;
  EXPECT_EQ(made["problems"][1]["world"], "table/scene0001") << made;
  std::filesystem::remove_all(folder_.path() / "out");
  files[0] = folder_.write("shelf/other0001.yaml", "world: {collision_objects: []}");
  const CommandRun doubtful = import("mbm", files);
  EXPECT_EQ(doubtful.status, exit_done) << "of the other folder";
  EXPECT_NE(doubtful.out.find("request0001.yaml: "), std::string::npos) << doubtful.out;
  EXPECT_NE(doubtful.out.find("/shelf/other0001', '"), std::string::npos) << doubtful.out;
  EXPECT_EQ(doubtful.out.find("shelf/shelf"), std::string::npos) << doubtful.out;
}

TEST_F(Import, AScenesMapWithoutRequestsIsNoSuiteAndSaidToBeNone) {
  const CommandRun run = import("scene", {folder_.write("a.yaml", "world: {collision_objects: []}")});
  EXPECT_EQ(run.status, exit_done);
  EXPECT_EQ(run.log, "clearway: import: no file is a request, so there are maps and no suite\n");
  EXPECT_TRUE(std::filesystem::exists(folder_ / "out/maps/a/map.ot"));
  EXPECT_FALSE(std::filesystem::exists(folder_ / "out/suite.yaml"));
}

}  // namespace import_test
}  // namespace clearway
