// Problem sets as JSON: `clearway import json`.
#include "datasets/descriptions/suite.hpp"
#include "tests/apps/problem_sets/import_fixture.hpp"

namespace clearway {
namespace import_test {

/// Turns by angles about the fixed axes x, y, z, and by their quaternion, computed by hand here: a quarter
/// turn about x, then one about z, takes z to x, and x to y.
TEST_F(Import, ASolidsTurnIsReadInEachFormThatIsUnambiguous) {
  const double quarter = 1.5707963267948966;
  const std::vector<std::pair<std::string, std::vector<double>>> forms{
      {"orientation_euler_xyz", {quarter, 0.0, quarter}},
      {"rpy", {quarter, 0.0, quarter}},
      {"orientation_quat_xyzw", {0.5, 0.5, 0.5, 0.5}},
      {"quaternion_xyzw", {0.5, 0.5, 0.5, 0.5}},
      {"orientation_quat_wxyz", {0.5, 0.5, 0.5, 0.5}}};
  for (auto [key, turn] : forms) {
    for (const bool is_mixed : {false, true}) {
      const bool is_quaternion = turn.size() == 4;
      if (is_mixed && !is_quaternion) continue;
      // All four numbers are alike above; a quarter turn about x alone tells their order.
      if (is_mixed)
        turn = key.ends_with("wxyz") ? std::vector<double>{0.7071068, 0.7071068, 0.0, 0.0}
                                     : std::vector<double>{0.7071068, 0.0, 0.0, 0.7071068};
      std::filesystem::remove_all(folder_ / "out");
      const Json set = {{"problems",
                         {{"a",
                           {{{"start", {0, 0, 0}},
                             {"goals", {{0.1, 0.1, 0}}},
                             {"box",
                              {{{"position", {0.05, 3.05, 0.05}},
                                {"half_extents", {0.04, 0.04, 0.44}},
                                {key, turn},
                                {"colour", "red"}}}}}}}}}};
      const CommandRun run = import("json", {folder_.write("a.json", set.dump())}, {"--json"});
      ASSERT_EQ(run.status, exit_done) << run.log << key;
      EXPECT_EQ(Json::parse(run.out)["left_out"], Json{"a 1: 'colour' of box 'box1'"});
      EXPECT_EQ(map("a_1").counts().occupied, 9U) << key;
      const Eigen::Vector3d end =
          is_mixed ? Eigen::Vector3d(0.05, 3.45, 0.05) : Eigen::Vector3d(0.45, 3.05, 0.05);
      EXPECT_EQ(map("a_1").state(end), VoxelState::occupied) << key;
    }
  }
}

TEST_F(Import, WhatItDoesNotUnderstandIsNeverTakenForFreeSpaceInSilence) {
  const auto import_with = [&](const std::string& more) {
    std::filesystem::remove_all(folder_.path() / "out");
    return import("json", {folder_.write("a.json",
                                         "{\"problems\": {\"a\": [{\"start\": [0, 0, 0], \"goals\": "
                                         "[[0.1, 0.1, 0]], " +
                                             more + "}]}}")});
  };
  for (const char* lost : {"\"cuboid\": [{}]", "\"spheres\": [[0, 0, 0, 1]]", "\"base_pose\": [1, 0, 0]",
                           "\"mesh\": {\"file\": \"a.stl\"}", "\"units\": \"mm\"", "\"frame\": \"table\""}) {
    const CommandRun run = import_with(lost);
    EXPECT_EQ(run.status, exit_bad_input) << lost;
    EXPECT_NE(run.log.find("expected no such key, as what it holds would be lost"), std::string::npos)
        << run.log;
  }
  for (const char* said : {"\"robot\": \"x\"", "\"metadata\": {\"a\": 1}", "\"difficulty\": 3"})
    EXPECT_NE(import_with(said).out.find("left out"), std::string::npos) << said;
  EXPECT_EQ(import_with("\"mesh\": [], \"cuboid\": {}").status, exit_done);
  std::filesystem::remove_all(folder_.path() / "out");
  const std::string scene =
      folder_.write("a.yaml", "world: {collision_objects: [{id: odd, parts: [{type: box}]}]}");
  EXPECT_NE(import("mbm", {scene}).out.find("'odd', which has neither primitives nor meshes"),
            std::string::npos);
}

/// A slip in one problem of many costs that problem; one in all of them is told at once.
TEST_F(Import, AProblemThatIsNotUnderstoodIsLeftOutWhereOthersAre) {
  const std::string good = R"({"start": [0, 0, 0], "goals": [[0.1, 0.1, 0]]})";
  const std::string odd = R"({"start": [0, 0, 0], "goals": [[0.1, 0.1, 0]], "spheres": [[0, 0, 0, 1]]})";
  const auto import_all = [&](const std::string& list) {
    std::filesystem::remove_all(folder_ / "out");
    return import("json", {folder_.write("a.json", R"({"problems": {"a": [)" + list + "]}}")}, {"--json"});
  };
  const CommandRun one = import_all(good + "," + odd + "," + good);
  ASSERT_EQ(one.status, exit_done) << one.log;
  const Json said = Json::parse(one.out);
  EXPECT_EQ(said["problems"], 2);
  ASSERT_EQ(said["left_out"].size(), 1U);
  const std::string left = said["left_out"][0];
  EXPECT_TRUE(left.starts_with("a, problem 2: problem set ")) << left;
  EXPECT_NE(left.find("expected no such key, as what it holds would be lost"), std::string::npos) << left;
  const CommandRun all = import_all(odd + "," + odd);
  EXPECT_EQ(all.status, exit_bad_input);
  EXPECT_NE(all.log.find("expected no such key, as what it holds would be lost"), std::string::npos)
      << all.log;
}

/// A capsule along y.
TEST_F(Import, CapsulesOfAProblemSetAreSolids) {
  const Json set = {{"problems",
                     {{"a",
                       {{{"start", {0, 0, 0}},
                         {"goals", {{0.1, 0.1, 0}}},
                         {"capsule",
                          {{{"position", {3.05, 0.25, 0.05}},
                            {"rpy", {1.5707963267948966, 0, 0}},
                            {"radius", 0.04},
                            {"length", 0.3}}}}}}}}}};
  ASSERT_EQ(import("json", {folder_.write("a.json", set.dump())}).status, exit_done);
  const Snapshot made = map("a_1");
  EXPECT_EQ(made.counts().occupied, 5U);  // y from 0.06 to 0.44: without its caps it ended at 0.4
  for (const double y : {0.05, 0.15, 0.25, 0.35, 0.45, 0.55})
    EXPECT_EQ(made.state({3.05, y, 0.05}) == VoxelState::occupied, y < 0.5) << y;
}

TEST_F(Import, JointNamesOfAProblemSayWhoseValuesTheseAre) {
  const auto with = [&](const Json& names, const Json& start) {
    std::filesystem::remove_all(folder_.path() / "out");
    const Json set = {
        {"problems", {{"a", {{{"start", start}, {"goals", {{0.02, -0.1, 0.5}}}, {"joint_names", names}}}}}}};
    return import("json", {folder_.write("a.json", set.dump())});
  };
  ASSERT_EQ(with({"grip", "elbow", "shoulder"}, {0.01, 0.1, -0.2}).status, exit_done);
  const SuiteProblem problem = load_suite(folder_.path() / "out/suite.yaml").experiments[0].problems[0];
  EXPECT_EQ(problem.start, (std::vector<double>{-0.2, 0.1, 0.01}));
  EXPECT_EQ(problem.goals[0], (std::vector<double>{0.5, -0.1, 0.02}));
  for (const auto& [run, why] :
       {std::pair(with({"grip", "elbow"}, {0.01, 0.1, -0.2}),
                  "expected 2 values, one for each of the joints that the file names"),
        std::pair(with({"grip", "elbow", "grip"}, {0.01, 0.1, -0.2}), "expected each name once"),
        std::pair(with({"grip", "elbow", "wrist"}, {0.01, 0.1, -0.2}),
                  "its goal names joint 'wrist', which robot 'arm' does not have")}) {
    EXPECT_EQ(run.status, exit_bad_input) << why;
    EXPECT_NE(run.log.find(why), std::string::npos) << run.log;
  }
}

/// VAMP's problem sets name the joints once for the file; a problem's own names count before these.
TEST_F(Import, JointsOfAProblemSetSayWhoseValuesTheseAre) {
  const Json plain = {{"start", {0.01, 0.1, -0.2}}, {"goals", {{0.02, -0.1, 0.5}}}};
  const Json named = {{"start", {-0.2, 0.1, 0.01}},
                      {"goals", {{0.5, -0.1, 0.02}}},
                      {"joint_names", {"shoulder", "elbow", "grip"}}};
  const Json set = {
      {"robot", "arm"}, {"joints", {"grip", "elbow", "shoulder"}}, {"problems", {{"a", {plain, named}}}}};
  const auto run = import("json", {folder_.write("a.json", set.dump())}, {"--json"});
  ASSERT_EQ(run.status, exit_done) << run.log;
  EXPECT_EQ(Json::parse(run.out)["left_out"], Json{"'robot'"});
  const Suite suite = load_suite(folder_.path() / "out/suite.yaml");
  ASSERT_EQ(suite.experiments[0].problems.size(), 2U);
  for (const SuiteProblem& problem : suite.experiments[0].problems) {
    EXPECT_EQ(problem.start, (std::vector<double>{-0.2, 0.1, 0.01}));
    EXPECT_EQ(problem.goals[0], (std::vector<double>{0.5, -0.1, 0.02}));
  }
  std::filesystem::remove_all(folder_.path() / "out");
  const Json sphere = {{"radius", 1}};
  for (const auto& [key, value] :
       std::vector<std::pair<std::string, Json>>{{"base_pose", Json::array({1, 0, 0})},
                                                 {"sphere", Json::array({sphere})},
                                                 {"boxes", {{"a", 1}}},
                                                 {"unit", "mm"},
                                                 {"basePose", "1 0 0"},
                                                 {"table_height", 0.7},
                                                 {"collisionObjects", Json::array({1})}}) {
    std::filesystem::remove_all(folder_.path() / "out");
    Json elsewhere = set;
    elsewhere[key] = value;
    const auto refused = import("json", {folder_.write("b.json", elsewhere.dump())});
    EXPECT_EQ(refused.status, exit_bad_input) << key;
    EXPECT_NE(refused.log.find(key), std::string::npos) << refused.log;
  }
  std::filesystem::remove_all(folder_.path() / "out");
  Json about = set;
  about["repository"] = {{"name", "x"}};
  about["exposition"] = 3;
  const auto taken = import("json", {folder_.write("b.json", about.dump())}, {"--json"});
  ASSERT_EQ(taken.status, exit_done) << taken.log;
  EXPECT_EQ(Json::parse(taken.out)["left_out"].size(), 3U);
}

}  // namespace import_test
}  // namespace clearway
