// `clearway import`: scenes, requests and problem sets that are written out here by hand.
#include <gtest/gtest.h>

#include <cstdlib>
#include <nlohmann/json.hpp>

#include "datasets/descriptions/suite.hpp"
#include "tests/apps/problem_sets/import_fixture.hpp"

namespace clearway {
namespace import_test {

/// Voxels of 0.1 m: a ball of 0.24 m about the middle of one meets those whose nearest point is so near.
std::size_t cubes_met_by_ball(double radius) {
  std::size_t count = 0;
  for (int x = -9; x <= 9; ++x)
    for (int y = -9; y <= 9; ++y)
      for (int z = -9; z <= 9; ++z) {
        const Eigen::Array3d nearest = (0.1 * Eigen::Array3d(x, y, z).abs() - 0.05).max(0.0);
        count += nearest.matrix().norm() <= radius;
      }
  return count;
}

TEST_F(Import, ScenesAndRequestsOfMotionBenchMakerBecomeASuiteThatIsSolved) {
  const std::string scene =
      folder_.write("scene0001.yaml",
                    "name: s\nrobot_model_name: arm\nfixed_frame_transforms:\n"
                    "  - header: {frame_id: world}\n    child_frame_id: shelf\n"
                    "    transform: {translation: [1.0, 0, 0], rotation: [0, 0, 0, 1]}\n"
                    "robot_state:\n  attached_collision_objects:\n    - {object: {id: mug}}\n"
                    "world:\n  octomap:\n    octomap: {data: []}\n  collision_objects:\n"
                    "    - id: ball\n      header: {frame_id: shelf}\n"
                    "      primitives: [{type: sphere, dimensions: [0.24]}]\n"
                    "      primitive_poses: [{position: [0.05, 3.05, 0.05], orientation: [0, 0, 0, 1]}]\n"
                    "    - id: post\n      header: {frame_id: /world}\n      pose: {position: {x: 5, z: 1}, "
                    "orientation: {w: 1}}\n"
                    "      primitives: [{type: 3, dimensions: [0.98, 0.02]}]\n"
                    "      primitive_poses: [{position: {x: 0.05, y: 0.05, z: 0.0}, orientation: {x: 0, y: "
                    "0, z: 0, w: 1}}]\n"
                    "    - id: floating\n      header: {frame_id: somewhere}\n"
                    "      primitives: [{type: box, dimensions: [1, 1, 1]}]\n      primitive_poses: "
                    "[{position: [0, 0, 0]}]\n");
  std::string request_text =
      arm_request +
      "path_constraints:\n  orientation_constraints: [{link_name: lower}]\n"
      "trajectory_constraints: {constraints: [{joint_constraints: [{joint_name: elbow}]}]}\n";
  request_text.insert(request_text.find("  joint_state"), "  is_diff: true\n");
  const std::string request = folder_.write("request0001.yaml", request_text);
  const CommandRun run = import("mbm", {scene, request}, {"--json", "--leave-out-unknown-frames"});
  ASSERT_EQ(run.status, exit_done) << run.log;
  const Json said = Json::parse(run.out);
  EXPECT_EQ(said["worlds"], 1);
  EXPECT_EQ(said["problems"], 1);
  const std::string left = said["left_out"].dump();
  for (const char* what : {"'mug', of which it shows no shape", "'floating' in frame 'somewhere'",
                           "orientation_constraints of the path", "trajectory_constraints"})
    EXPECT_NE(left.find(what), std::string::npos) << left;
  const Snapshot world = map("scene0001");
  EXPECT_EQ(world.counts().occupied, cubes_met_by_ball(0.24) + 10);  // the post: ten voxels, one on another
  EXPECT_EQ(world.state({5.05, 0.05, 1.45}), VoxelState::occupied);
  EXPECT_EQ(world.state({5.05, 0.05, 1.55}), VoxelState::unknown);

  const Suite suite = load_suite(folder_.path() / "out/suite.yaml");
  ASSERT_EQ(suite.experiments.size(), 1U);
  EXPECT_EQ(suite.experiments[0].name, "arm");
  EXPECT_EQ(suite.experiments[0].fixed, (std::map<std::string, double>{{"grip", 0.02}}));
  ASSERT_EQ(suite.experiments[0].problems.size(), 1U);
  EXPECT_EQ(suite.experiments[0].problems[0].start, (std::vector<double>{0.0, 0.1}));
  EXPECT_EQ(suite.experiments[0].problems[0].goals, (std::vector<std::vector<double>>{{0.5, -0.1}}));
  const Json record = Json::parse(read_file(folder_.file("out/import.json")));
  EXPECT_EQ(record["worlds"][0]["objects"][0]["object"], "ball");
  EXPECT_EQ(record["problems"][0]["group"], "arm");

  const CommandRun compared =
      run_command({"compare", "--worst-pages", "0", folder_.file("out/suite.yaml"), "--planners",
                   "rrtconnect,beam", "--out", folder_.file("results"), "--json"});
  EXPECT_EQ(compared.status, exit_done) << compared.log;
  const Json planners = Json::parse(compared.out)["experiments"][0]["planners"];
  ASSERT_EQ(planners.size(), 2U);  // the suite lists rrtconnect alone
  for (const Json& planner : planners) EXPECT_EQ(planner["valid"], 1) << planner;
}

/// Objects stand in the frames that MoveIt knows: of links that stand still, of the SRDF's virtual joint, and
/// those that fixed_frame_transforms places in another one (moveit_core's Transforms: `header` in `child`).
TEST_F(Import, ObjectsStandInTheFramesOfLinksThatStandStillAndInMoveItsTransforms) {
  using namespace worlds;
  robot_ = folder_.write(
      "arm.urdf",
      "<robot name='arm'><link name='world'/>" + urdf_link("pedestal", "0 0 0", "<sphere radius='0.01'/>") +
          urdf_link("upper", "0.2 0 0", "<sphere radius='0.05'/>") +
          urdf_joint("mount", "fixed", "world", "pedestal", "0 0 2", "0 0 1", "") +
          urdf_joint("shoulder", "revolute", "pedestal", "upper", "0 0 0", "0 0 1", urdf_limit(-2, 2)) +
          "</robot>");
  folder_.write("arm.srdf",
                "<robot name='arm'><virtual_joint name='v' type='fixed' parent_frame='odom' "
                "child_link='world'/></robot>");
  const auto object = [](const std::string& name, const std::string& frame) {
    return "    - {id: " + name + ", header: {frame_id: " + frame +
           "}, primitives: [{type: sphere, dimensions: [0.01]}], primitive_poses: [{position: [0.05, 0.05, "
           "0.05]}]}\n";
  };
  const std::string scene = folder_.write("s.yaml",
                                          "fixed_frame_transforms:\n"
                                          "  - {header: {frame_id: camera/lens}, child_frame_id: pedestal, "
                                          "transform: {translation: [1, 0, 0], rotation: [0, 0, "
                                          "0, 1]}}\n"
                                          "world:\n  collision_objects:\n" +
                                              object("a", "pedestal") + object("b", "odom") +
                                              object("c", "camera/lens") + object("d", "upper"));
  const CommandRun run = import("mbm", {scene}, {"--leave-out-unknown-frames"});
  ASSERT_EQ(run.status, exit_done) << run.log;
  EXPECT_NE(run.out.find("'d' in frame 'upper', which is not the map's"), std::string::npos) << run.out;
  EXPECT_EQ(run.out.find("frame 'pedestal'"), std::string::npos) << run.out;
  const Snapshot world = map("s");
  EXPECT_EQ(world.counts().occupied, 3U);
  for (const Eigen::Vector3d& at : {Eigen::Vector3d(0.05, 0.05, 2.05), Eigen::Vector3d(0.05, 0.05, 0.05),
                                    Eigen::Vector3d(1.05, 0.05, 2.05)})
    EXPECT_EQ(world.state(at), VoxelState::occupied) << at.transpose();
}

/// The folders of a set count their scenes from 1 in each. What a request does not say of the robot its scene
/// does, and what a file rounds beyond a limit is the limit.
TEST_F(Import, RequestsGoWithTheScenesOfTheirFolderAndStartWhereTheseLeaveTheRobot) {
  Arguments files;
  for (const char* folder : {"shelf", "table"}) {
    std::filesystem::create_directories(folder_.path() / folder);
    const std::string at = std::string(folder) == "shelf" ? "3" : "5";
    files.push_back(
        folder_.write(std::string(folder) + "/scene0001.yaml",
                      "robot_state: {joint_state: {name: [grip, shoulder], position: [0.05, 1]}}\n"
                      "world: {collision_objects: [{id: a, primitives: [{type: sphere, dimensions: [0.01]}], "
                      "primitive_poses: [{position: [0, 0, " +
                          at + "]}]}]}\n"));
    files.push_back(
        folder_.write(std::string(folder) + "/request0001.yaml",
                      "start_state: {joint_state: {name: [shoulder, elbow], position: [0.25, -2.0000004]}}\n"
                      "goal_constraints: [{joint_constraints: [{joint_name: shoulder, position: 0.5}, "
                      "{joint_name: elbow, position: 0}]}]\n"));
  }
  const CommandRun run = import("mbm", files);
  ASSERT_EQ(run.status, exit_done) << run.log;
  const Suite suite = load_suite(folder_.path() / "out/suite.yaml");
  ASSERT_EQ(suite.experiments.size(), 2U);  // one for each folder, called as that
  const Json record = Json::parse(read_file(folder_.file("out/import.json")));
  ASSERT_EQ(record["worlds"].size(), 2U);
  for (std::size_t i = 0; i < 2; ++i) {
    const SuiteExperiment& experiment = suite.experiments[i];
    const std::string folder = i == 0 ? "shelf" : "table";
    EXPECT_EQ(experiment.name, folder);
    EXPECT_EQ(experiment.fixed, (std::map<std::string, double>{{"grip", 0.05}}));
    ASSERT_EQ(experiment.problems.size(), 1U);
    EXPECT_EQ(experiment.problems[0].name, "request0001");
    EXPECT_EQ(experiment.problems[0].start, (std::vector<double>{0.25, -2.0}));
    EXPECT_EQ(experiment.problems[0].world, folder + "_scene0001");
    EXPECT_EQ(map(folder + "_scene0001").state({0.05, 0.05, i == 0 ? 3.05 : 5.05}), VoxelState::occupied);
  }
}

TEST_F(Import, TwoFoldersOfOneNameAreTwoExperiments) {
  Arguments files;
  for (const char* folder : {"a/shelf", "b/shelf"}) {
    std::filesystem::create_directories(folder_.path() / folder);
    files.push_back(folder_.write(std::string(folder) + "/scene1.yaml", "world: {collision_objects: []}\n"));
    files.push_back(folder_.write(std::string(folder) + "/request1.yaml", arm_request));
  }
  ASSERT_EQ(import("mbm", files).status, exit_done);
  const Suite suite = load_suite(folder_.path() / "out/suite.yaml");
  ASSERT_EQ(suite.experiments.size(), 2U);
  EXPECT_EQ(suite.experiments[0].name, "shelf");
  EXPECT_EQ(suite.experiments[1].name, "shelf-2");
}

TEST_F(Import, SuitesListAutoBesideRrtConnect) {
  const std::string scene = folder_.write("scene1.yaml", "world: {collision_objects: []}\n");
  ASSERT_EQ(import("mbm", {scene, folder_.write("request1.yaml", arm_request)}).status, exit_done);
  const Suite suite = load_suite(folder_.path() / "out/suite.yaml");
  std::vector<std::string> planners;
  for (const SuitePlanner& planner : suite.experiments.at(0).planners) planners.push_back(planner.planner);
  EXPECT_EQ(planners, (std::vector<std::string>{"auto", "rrtconnect"}));
}

/// What the robot cannot take of a start is said once, whatever number of problems has it; joints that its
/// settings hold stand where the start has them.
TEST_F(Import, JointsOfStartsThatTheRobotCannotTakeAreListedOnce) {
  using namespace worlds;
  std::string urdf = arm_with_finger();
  urdf.insert(urdf.rfind("</robot>"),
              urdf_link("head", "0 0 0", "<sphere radius='0.01'/>") +
                  urdf_link("neck", "0 0 0", "<sphere radius='0.01'/>") +
                  urdf_joint("pan", "fixed", "base", "neck", "0 0 1", "0 0 1", "") +
                  urdf_joint("tilt", "fixed", "neck", "head", "0 0 0.2", "0 0 1", ""));
  robot_ = folder_.write("arm.urdf", urdf);
  folder_.write("arm.yaml", "urdf: arm.urdf\nfixed: {grip: 0.01}\n");
  std::string request = arm_request;
  request.replace(request.find("[grip, elbow, shoulder]"), 23, "[grip, elbow, shoulder, pan, tilt, elbwo]");
  request.replace(request.find("[0.02, 0.1, 0.0]"), 16, "[0.02, 0.1, 0.0, 0.5, 0, 0.7]");
  Arguments files{folder_.write("scene.yaml", "world: {collision_objects: []}\n")};
  for (const char* number : {"1", "2"})
    files.push_back(folder_.write(std::string("request") + number + ".yaml", request));
  const CommandRun run = import("mbm", files, {"--json"});
  ASSERT_EQ(run.status, exit_done) << run.log;
  const Json left = Json::parse(run.out)["left_out"];
  EXPECT_EQ(std::count(left.begin(), left.end(), "start states: elbwo, which robot 'arm' does not have"), 1)
      << left;
  EXPECT_EQ(std::count(left.begin(), left.end(),
                       "start states: pan, which the robot's file fixes, elsewhere than at 0"),
            1)
      << left;
  EXPECT_EQ(left.dump().find("tilt"), std::string::npos) << left;
  EXPECT_EQ(Json::parse(read_file(folder_.file("out/import.json")))["left_out"], left);
  EXPECT_EQ(load_suite(folder_.path() / "out/suite.yaml").experiments.at(0).fixed,
            (std::map<std::string, double>{{"grip", 0.02}}));
}

TEST_F(Import, AStateThatIsFixedHoldsTheJointsOutsideOfTheGroup) {
  folder_.write("arm.srdf",
                "<robot name='arm'><group name='arm'><joint name='shoulder'/><joint name='elbow'/></group>"
                "<group name='hand'><joint name='grip'/></group>"
                "<group_state name='open' group='hand'><joint name='grip' value='0.04'/></group_state>"
                "<group_state name='shut' group='hand'><joint name='grip' value='0'/></group_state></robot>");
  const std::string set =
      folder_.write("p.json", R"({"problems": {"free": [{"start": [0, 0.1], "goals": [[0.5, -0.1]]}]}})");
  const CommandRun run = import("json", {set}, {"--group", "arm", "--fix", "open"});
  ASSERT_EQ(run.status, exit_done) << run.log;
  const auto fixed = [&] { return load_suite(folder_.path() / "out/suite.yaml").experiments.at(0).fixed; };
  EXPECT_EQ(fixed(), (std::map<std::string, double>{{"grip", 0.04}}));
  std::filesystem::remove_all(folder_ / "out");
  ASSERT_EQ(import("json", {set}, {"--group", "arm", "--fix", "open", "--fix", "grip=0.03"}).status,
            exit_done);
  EXPECT_EQ(fixed(), (std::map<std::string, double>{{"grip", 0.03}}));
  std::filesystem::remove_all(folder_ / "out");
  const std::string scene = folder_.write("scene1.yaml", "world: {collision_objects: []}\n");
  ASSERT_EQ(import("mbm", {scene, folder_.write("request1.yaml", arm_request)}, {"--fix", "open"}).status,
            exit_done);
  EXPECT_EQ(fixed(), (std::map<std::string, double>{{"grip", 0.04}})) << "before what the start says";
  const auto refused = [&](const Arguments& flags, const std::string& words) {
    Arguments all{"--group", "arm"};
    all.insert(all.end(), flags.begin(), flags.end());
    std::filesystem::remove_all(folder_ / "out");
    const CommandRun wrong = import("json", {set}, all);
    EXPECT_EQ(wrong.status, exit_bad_input);
    EXPECT_NE(wrong.log.find(words), std::string::npos) << wrong.log;
  };
  refused({"--fix", "opne"}, "or a state of the robot's SRDF, got 'opne', did you mean 'open'?");
  refused({"--fix", "open", "--fix", "shut"}, "--fix: two states have joint 'grip' at two values");
}

TEST_F(Import, BothTextsOfMoveItsScenesAreReadAndMeshesAreTheirSurface) {
  const std::string old_form = folder_.write(
      "old.scene", "(noname)\n* the box\n1\nbox\n0.18 0.18 0.18\n1.1 0.1 0.1\n0 0 0 1\n0 0 0 0\n.\n");
  const std::string new_form = folder_.write(
      "new.scene",
      "(noname)\n* the box\n1 0 0\n0 0 0 1\n2\nbox\n0.18 0.18 0.18\n0.1 0.1 0.1\n0 0 0 1\n0 0 0 0\n"
      "sphere\n0.01\n2.05 0.05 0.05\n0 0 0 1\n0 0 0 0\n1\ntip\n0 0 0\n0 0 0 1\n"
      "* sheet\n0 0 0\n0 0 0.7071067811865476 0.7071067811865476\n1\nmesh\n3 1\n0.05 0.05 3.05\n0.33 0.05 "
      "3.05\n0.05 0.33 3.05\n"
      "0 1 2\n0 0 0\n0 0 0 1\n0 0 0 0\n0\n.\n");
  ASSERT_EQ(import("scene", {old_form, new_form}).status, exit_done);
  EXPECT_EQ(map("old").counts().occupied, 8U);
  const Snapshot world = map("new");
  EXPECT_EQ(world.counts().occupied,
            8U + 1U + 10U);  // the triangle turned by 90 degrees: 4 + 3 + 2 + 1 voxels
  EXPECT_EQ(world.state({1.05, 0.05, 0.05}), VoxelState::occupied);
  EXPECT_EQ(world.state({-0.35, 0.05, 3.05}), VoxelState::occupied);
  EXPECT_NE(import("scene", {old_form}).log.find("holds an import already"), std::string::npos);
}

/// As Robowflex and ROS write them, and as plain arrays.
TEST_F(Import, MeshesInsideAreReadInEachFormOfVerticesWithEachOfTriangles) {
  for (const char* vertices :
       {"[[0.05, 0.05, 3.05], [0.33, 0.05, 3.05], [0.05, 0.33, 3.05]]",
        "[{x: 0.05, y: 0.05, z: 3.05}, {x: 0.33, y: 0.05, z: 3.05}, [0.05, 0.33, 3.05]]",
        "[0.05, 0.05, 3.05, 0.33, 0.05, 3.05, 0.05, 0.33, 3.05]"}) {
    for (const char* triangles : {"[[0, 2, 1]]", "[{vertex_indices: [0, 2, 1]}]",
                                  "[{vertex_indices: [0, 2, 1]}, [0, 1, 2]]", "[0, 2, 1]"}) {
      std::filesystem::remove_all(folder_ / "out");
      const std::string scene = folder_.write(
          "s.yaml", "world: {collision_objects: [{id: a, meshes: [{vertices: " + std::string(vertices) +
                        ", triangles: " + triangles + "}]}]}");
      const CommandRun run = import("mbm", {scene});
      ASSERT_EQ(run.status, exit_done) << run.log << vertices << triangles;
      EXPECT_EQ(map("s").counts().occupied, 10U);  // 4 + 3 + 2 + 1 voxels
    }
  }
}

TEST_F(Import, AppearsWholeOrNotAtAllBesideWhatIsThere) {
  const std::string scene = folder_.write(
      "old.scene", "(noname)\n* the box\n1\nbox\n0.18 0.18 0.18\n1.1 0.1 0.1\n0 0 0 1\n0 0 0 0\n.\n");
  const CommandRun unread = import("scene", {folder_.file("nowhere.scene")});
  EXPECT_EQ(unread.status, exit_bad_input);
  EXPECT_FALSE(std::filesystem::exists(folder_ / "out"));
  std::filesystem::create_directory(folder_ / "out");
  folder_.write("out/notes.md", "mine");
  ASSERT_EQ(import("scene", {scene}).status, exit_done);
  EXPECT_EQ(read_file(folder_ / "out/notes.md"), "mine");
  EXPECT_EQ(map("old").counts().occupied, 8U);
  EXPECT_EQ(std::distance(std::filesystem::directory_iterator(folder_.path()), {}), 3);  // and nothing hidden
}

TEST_F(Import, RefusesBeforeTheWorkAFolderThatItCannotWrite) {
  folder_.write("file", "no folder");
  std::filesystem::create_directories(folder_ / "mine/maps");
  for (const auto& [place, words] :
       {std::pair{"file", "it exists and is not a folder"}, std::pair{"file/out", "is not a folder"},
        std::pair{"mine", "such as 'maps'"}}) {
    const CommandRun run = run_command(
        {"import", "--out", folder_.file(place), "--robot", robot_, "scene", folder_.file("nowhere.scene")});
    EXPECT_EQ(run.status, exit_bad_input) << place;
    EXPECT_TRUE(run.complains_in_one_sentence()) << run.log;
    EXPECT_NE(run.log.find(words), std::string::npos) << run.log;
  }
}

TEST_F(Import, ProblemsOfJsonAreOneExperimentForEachNameWithAWorldEach) {
  const Json set = {{"problems",
                     {{"shelf",
                       {{{"index", 1},
                         {"valid", true},
                         {"start", {0.0, 0.1}},
                         {"goals", {{0.5, -0.1}, {0.6, 0.0}}},
                         {"sphere", {{{"position", {1.05, 3.05, 0.05}}, {"radius", 0.24}, {"name", "ball"}}}},
                         {"box",
                          {{{"position", {3.0, 0.0, 0.05}},
                            {"orientation_euler_xyz", {0.0, 0.0, 1.5707963267948966}},
                            {"half_extents", {0.46, 0.04, 0.04}}}}}},
                        {{"index", 2}, {"valid", false}, {"start", {0.0, 0.1}}, {"goals", {{0.5, -0.1}}}},
                        {{"index", 3}, {"start", {0.0, 0.2}}, {"goals", {{0.5, -0.1}}}}}},
                      {"table", {{{"start", {0.0, 0.1}}, {"goals", {{0.4, -0.1}}}}}}}}};
  const std::string file = folder_.write("problems.json", set.dump());
  const CommandRun run = import("json", {file}, {"--fix", "grip=0.03"});
  ASSERT_EQ(run.status, exit_done) << run.log;
  const Suite suite = load_suite(folder_.path() / "out/suite.yaml");
  ASSERT_EQ(suite.experiments.size(), 2U);
  EXPECT_EQ(suite.experiments[0].problems.size(), 2U);
  EXPECT_EQ(suite.experiments[0].problems[1].world, "shelf_3");
  EXPECT_EQ(suite.experiments[0].fixed.at("grip"), 0.03);
  EXPECT_NE(run.out.find("shelf 2: it says that it is not valid"), std::string::npos) << run.out;
  EXPECT_EQ(Json::parse(read_file(folder_.file("out/import.json")))["problems"][0]["goal"],
            (Json{{"number", 1}, {"of", 2}, {"free", true}}));
  // The box, turned about z: along y, 10 voxels of y and 2 of x.
  EXPECT_EQ(map("shelf_1").counts().occupied, cubes_met_by_ball(0.24) + 20);
  const CommandRun compared = run_command(
      {"compare", "--worst-pages", "0", folder_.file("out/suite.yaml"), "--out", folder_.file("results")});
  EXPECT_EQ(compared.status, exit_done) << compared.log;
  EXPECT_NE(compared.out.find("== all experiments"), std::string::npos);
  EXPECT_NE(compared.out.find("3 / 3 / 3"), std::string::npos) << compared.out;
  const CommandRun wrong =
      run_command({"import", "json", file, "--out", folder_.file("other"), "--robot", robot_});
  EXPECT_EQ(wrong.status, exit_bad_input);
  EXPECT_NE(wrong.log.find("problem 'shelf 1', start: got 2 values, expected 3"), std::string::npos)
      << wrong.log;
}

/// `rostopic echo` writes all fields, empty ones as '', `ros2 topic echo` a byte as its character; words of
/// an operation are Robowflex's.
/// moveit_core's PlanningScene: ADD puts an object in the place of the one of its name, APPEND beside it.
TEST_F(Import, AnObjectThatIsAddedAgainReplacesTheOneOfItsName) {
  const auto ball = [](double x, const std::string& operation) {
    return "{id: ball, primitives: [{type: sphere, dimensions: [0.01]}], primitive_poses: [{position: [" +
           std::to_string(x) + ", 0.05, 0.05]}], operation: " + operation + "}";
  };
  const std::string scene =
      folder_.write("s.yaml", "world: {collision_objects: [" + ball(1.05, "0") + ", " + ball(2.05, "append") +
                                  ", " + ball(3.05, "add") + ", " + ball(4.05, "append") + "]}");
  const CommandRun run = import("mbm", {scene}, {"--json"});
  ASSERT_EQ(run.status, exit_done) << run.log;
  EXPECT_EQ(Json::parse(run.out)["left_out"], Json::array());
  const Snapshot world = map("s");
  EXPECT_EQ(world.counts().occupied, 2U);
  EXPECT_EQ(world.state({3.05, 0.05, 0.05}), VoxelState::occupied);
  EXPECT_EQ(world.state({4.05, 0.05, 0.05}), VoxelState::occupied);
}

TEST_F(Import, EmptyWordsAndOperationsAreReadAsEachToolWritesThem) {
  const auto object = [](const std::string& name, const std::string& operation) {
    return "    - {id: " + name +
           ", header: {frame_id: ''}, type: {key: '', db: ''}, primitives: [{type: 1, dimensions: "
           "[0.1, 0.1, 0.1]}], primitive_poses: [{position: {x: 3.0, y: 0.0, z: 0.0}}], meshes: [], "
           "mesh_poses: [], "
           "planes: [], operation: " +
           operation + "}\n";
  };
  std::string scene =
      "robot_model_name: ''\nfixed_frame_transforms: [{header: {frame_id: ''}, child_frame_id: ''}]\n"
      "world:\n  collision_objects:\n";
  int count = 0;
  for (const char* added : {"0", "\"\\0\"", "\"\\x02\"", "2", "add", "Append", "''", "!!binary AA=="})
    scene += object("in" + std::to_string(count++), added);
  for (const char* other : {"1", "\"\\x01\"", "remove", "MOVE", "3"})
    scene += object("out" + std::to_string(count++), other);
  scene += "    - {id: none, primitives: [], meshes: [], planes: [], operation: 0}\n";
  const CommandRun run =
      import("mbm",
             {folder_.write("scene.yaml", scene),
              folder_.write("request.yaml", arm_request + "path_constraints: {name: ''}\nplanner_id: ''\n")},
             {"--json"});
  ASSERT_EQ(run.status, exit_done) << run.log;
  EXPECT_EQ(Json::parse(run.out)["left_out"],
            (Json{"scene.yaml: the removal of object 'out8', which is not there",
                  "scene.yaml: the removal of object 'out9', which is not there",
                  "scene.yaml: the removal of object 'out10', which is not there",
                  "scene.yaml: the move of object 'out11', which is not there",
                  "scene.yaml: the move of object 'out12', which is not there",
                  "scene.yaml: object 'none', which has neither primitives nor meshes"}));
  const Json record = Json::parse(read_file(folder_.file("out/import.json")));
  EXPECT_EQ(record["worlds"][0]["objects"].size(), 8U);
  std::filesystem::remove_all(folder_ / "out");
  for (const char* odd : {"odd", "4", "b'\\x00'", "!!binary AAA="}) {
    const CommandRun refused =
        import("mbm", {folder_.write("odd.yaml", "world:\n  collision_objects:\n" + object("box", odd)),
                       folder_.file("request.yaml")});
    EXPECT_EQ(refused.status, exit_bad_input) << odd;
    EXPECT_NE(refused.log.find("operation"), std::string::npos) << refused.log;
    EXPECT_NE(refused.log.find("expected ADD (0), REMOVE (1)"), std::string::npos) << refused.log;
  }
  std::string unnamed = arm_request;
  unnamed.replace(unnamed.find("group_name: arm"), 15, "group_name: ''");
  EXPECT_EQ(import("mbm", {folder_.file("scene.yaml"), folder_.write("request.yaml", unnamed)}).status,
            exit_done);
}

/// Both as ROS writes it and as Robowflex does.
TEST_F(Import, WhatASceneSaysOfContactsPaddingsAndTheRobotIsSaidToBeLeftOut) {
  const auto left_out_of = [&](const std::string& more) {
    std::filesystem::remove_all(folder_ / "out");
    const std::string scene = folder_.write(
        "s.yaml", more +
                      "\nworld: {collision_objects: [{id: mug, primitives: [{type: sphere, dimensions: "
                      "[0.01]}]}, {id: pan, primitives: [{type: sphere, dimensions: [0.01]}]}]}");
    const CommandRun run = import("mbm", {scene}, {"--json"});
    EXPECT_EQ(run.status, exit_done) << run.log;
    const Json left = Json::parse(run.out)["left_out"];
    EXPECT_EQ(Json::parse(read_file(folder_.file("out/import.json")))["left_out"], left);
    return left;
  };
  const std::string rows[] = {"[false, true, true, true]", "[true, False, true, true]",
                              "[true, true, false, false]", "[true, false, false, false]"};
  for (const bool is_ros : {true, false}) {
    std::string values;
    for (const std::string& row : rows)
      values += (values.empty() ? "" : ", ") + (is_ros ? "{enabled: " + row + "}" : row);
    EXPECT_EQ(
        left_out_of("allowed_collision_matrix: {entry_names: [upper, mug, pan, lower], entry_values: [" +
                    values + "], default_entry_names: [pan, upper], default_entry_values: [true, true]}"),
        (Json{"s.yaml: its allowed_collision_matrix: 1 pair that one of its two entries alone allows, the "
              "first 'mug' with 'lower'",
              "s.yaml: its allowed_collision_matrix: objects that may collide with everything: pan",
              "s: which links may touch mug, pan (allowed_collision_matrix): without a problem they block "
              "all"}));
  }
  EXPECT_EQ(left_out_of("link_padding: [{link_name: upper, padding: 0}, {link_name: lower, padding: 0.01}]\n"
                        "link_scale: [{link_name: upper, scale: 1.1}, {link_name: lower, scale: 1}]"),
            (Json{"s.yaml: its link_padding of lower", "s.yaml: its link_scale of upper"}));
  EXPECT_EQ(left_out_of("author: me"), (Json{"s.yaml: key 'author'"}));
  EXPECT_EQ(left_out_of("robot_model_name: leg"),
            (Json{"s.yaml: its robot_model_name, 'leg', which is not the robot's name"}));
  EXPECT_EQ(left_out_of("robot_model_name: arm\nallowed_collision_matrix: {entry_names: [upper, lower], "
                        "entry_values: [[false, true], [true, false]]}"),
            Json::array());
  robot_ = folder_.write("mine.urdf", worlds::arm_with_finger());
  EXPECT_EQ(left_out_of("robot_model_name: arm"), Json::array());  // by the name inside the URDF
}

TEST_F(Import, ArgumentsOfXacroAreTheSuitesToo) {
  const std::string program =
      folder_.write("xacro", "#!/bin/sh\n[ \"$2\" = side:=left ] && cat " + robot_ + "\n");
  std::filesystem::permissions(program, std::filesystem::perms::owner_all);
  robot_ = folder_.write("arm.urdf.xacro", "<robot name='arm'/>");
  const std::string before = std::getenv("PATH") ? std::getenv("PATH") : "";
  ::setenv("PATH", (folder_.path().string() + ":/usr/bin:/bin").c_str(), 1);
  const std::string scene = folder_.write("a.yaml", "world: {collision_objects: []}");
  const CommandRun run =
      import("mbm", {scene, folder_.write("b.yaml", arm_request)}, {"--xacro", "side:=left"});
  ASSERT_EQ(run.status, exit_done) << run.log;
  EXPECT_EQ(load_suite(folder_ / "out/suite.yaml").experiments[0].xacro,
            (std::map<std::string, std::string>{{"side", "left"}}));
  const CommandRun compared = run_command(
      {"compare", "--worst-pages", "0", folder_.file("out/suite.yaml"), "--out", folder_.file("results")});
  EXPECT_EQ(compared.status, exit_done) << compared.log;
  ::setenv("PATH", before.c_str(), 1);
}

}  // namespace import_test
}  // namespace clearway
