// One scene, request or problem that cannot be read costs itself, not the set that it is of.
#include "datasets/descriptions/suite.hpp"
#include "tests/apps/problem_sets/import_fixture.hpp"

namespace clearway {
namespace import_test {

class LeftOut : public Import {
 protected:
  std::string scene(const std::string& number, double radius, double height) const {
    return folder_.write("scene" + number + ".yaml",
                         "world: {collision_objects: [{id: a, primitives: [{type: sphere, dimensions: [" +
                             std::to_string(radius) + "]}], primitive_poses: [{position: [0, 0, " +
                             std::to_string(height) + "]}]}]}\n");
  }
  std::string request(const std::string& number, const std::string& elbow = "0") const {
    return folder_.write("request" + number + ".yaml",
                         "start_state: {joint_state: {name: [shoulder, elbow], position: [0.25, -1.5]}}\n"
                         "goal_constraints: [{joint_constraints: [{joint_name: shoulder, position: 0.5}, "
                         "{joint_name: elbow, position: " +
                             elbow + "}]}]\n");
  }
  std::vector<std::string> worlds_of_problems() const {
    std::vector<std::string> worlds;
    for (const SuiteProblem& problem : load_suite(folder_.path() / "out/suite.yaml").experiments[0].problems)
      worlds.push_back(problem.world);
    return worlds;
  }
};

TEST_F(LeftOut, ASceneWithItsRequestsAndARequestAlone) {
  const Arguments files{scene("0001", 0.0, 3.0), scene("0002", 0.1, 4.0), scene("0003", 0.1, 5.0),
                        request("0001"),         request("0002"),         request("0003", "much")};
  const CommandRun run = import("mbm", files, {"--json"});
  ASSERT_EQ(run.status, exit_done) << run.log;
  const Json said = Json::parse(run.out);
  EXPECT_EQ(said["worlds"], 2);
  EXPECT_EQ(said["problems"], 1);
  ASSERT_EQ(said["left_out"].size(), 3U) << said["left_out"];
  EXPECT_NE(said["left_out"][0].get<std::string>().find("scene0001.yaml: "), std::string::npos);
  EXPECT_EQ(said["left_out"][1], "request0001.yaml: its scene was left out");
  EXPECT_NE(said["left_out"][2].get<std::string>().find("request0003.yaml: "), std::string::npos);
  // Of the second scene, at 4 m: the request has not slid to another.
  EXPECT_EQ(map("scene0002").state({0.0, 0.0, 4.0}), VoxelState::occupied);
  EXPECT_EQ(map("scene0003").state({0.0, 0.0, 5.0}), VoxelState::occupied);
  ASSERT_EQ(worlds_of_problems().size(), 1U);
  EXPECT_NE(worlds_of_problems()[0].find("scene0002"), std::string::npos);
}

/// Two scenes, of which one is left, are not "one scene with all requests".
TEST_F(LeftOut, TheSceneThatIsLeftTakesNoRequestOfTheOther) {
  const CommandRun run =
      import("mbm", {scene("0001", 0.1, 3.0), scene("0002", 0.0, 4.0), request("0002"), request("0001")},
             {"--json"});
  ASSERT_EQ(run.status, exit_done) << run.log;
  const Json said = Json::parse(run.out);
  EXPECT_EQ(said["problems"], 1);
  EXPECT_EQ(said["left_out"][1], "request0002.yaml: its scene was left out");
}

TEST_F(LeftOut, AFileThatIsNoYamlAndARequestWithoutAScene) {
  const std::string cut = folder_.write("scene0002.yaml", "world: {collision_objects: [{id: a,");
  const CommandRun run = import("mbm",
                                {scene("0001", 0.1, 3.0), cut, request("0001"), request("0002"),
                                 folder_.write("request0003.yaml", "start_state: {"), request("0004")},
                                {"--json"});
  ASSERT_EQ(run.status, exit_done) << run.log;
  const Json said = Json::parse(run.out);
  EXPECT_EQ(said["worlds"], 1);
  EXPECT_EQ(said["problems"], 1);
  EXPECT_EQ(said["left_out"].size(), 4U) << said["left_out"];
}

TEST_F(LeftOut, AProblemOfRobometrics) {
  const std::string problem =
      "- {start: [0, 0, 0], goal_ik: [[0.5, 0, 0]], obstacles: {cuboid: {far: {dims: [0.1, 0.1, ";
  const CommandRun run =
      import("robometrics",
             {folder_.write("set.yaml", "easy:\n" + problem + "0.0], pose: [9, 9, 9, 1, 0, 0, 0]}}}}\n" +
                                            problem + "0.1], pose: [8, 9, 9, 1, 0, 0, 0]}}}}\n")},
             {"--json"});
  ASSERT_EQ(run.status, exit_done) << run.log;
  const Json said = Json::parse(run.out);
  EXPECT_EQ(said["worlds"], 1);
  EXPECT_EQ(said["problems"], 1);
  ASSERT_EQ(said["left_out"].size(), 1U);
  EXPECT_NE(said["left_out"][0].get<std::string>().find("easy 1: "), std::string::npos) << said["left_out"];
}

TEST_F(LeftOut, WhereNothingIsLeftTheFirstFaultIsTheRefusal) {
  EXPECT_NE(import("mbm", {scene("0001", 0.0, 3.0), request("0001")}).status, exit_done);
  EXPECT_NE(import("mbm", {scene("0001", 0.1, 3.0), request("0001", "much")}).status, exit_done);
  EXPECT_TRUE(import("mbm", {scene("0001", 0.0, 3.0), request("0001")}).complains_in_one_sentence());
  EXPECT_FALSE(std::filesystem::exists(folder_.path() / "out"));
}

TEST_F(LeftOut, AListThatEchoShortenedIsToldAsSuch) {
  const std::string file =
      folder_.write("scene0001.yaml",
                    "world: {collision_objects: [{id: a, primitives: [{type: 1, dimensions: [0.1, '...']}], "
                    "primitive_poses: [{position: [0, 0, 3]}]}]}\n");
  const CommandRun run = import("mbm", {file, request("0001")});
  EXPECT_EQ(run.status, exit_bad_input);
  EXPECT_NE(run.log.find("--full-length"), std::string::npos) << run.log;
}

}  // namespace import_test
}  // namespace clearway
