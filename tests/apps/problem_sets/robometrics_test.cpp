// Problem sets of robometrics and worlds of cuRobo: `clearway import robometrics`.
#include "apps/suites/suite_cells.hpp"
#include "datasets/descriptions/suite.hpp"
#include "planning/robot/goal_configurations.hpp"
#include "planning/robot/kinematics.hpp"
#include "planning/robot_files/load_robot.hpp"
#include "tests/apps/problem_sets/import_fixture.hpp"

namespace clearway {
namespace import_test {

class Robometrics : public Import {
 protected:
  CommandRun import_text(const std::string& text, const Arguments& more = {}) const {
    std::filesystem::remove_all(folder_.path() / "out");
    return import("robometrics", {folder_.write("set.yaml", text)}, more);
  }

  SuiteProblem problem(std::size_t number = 0) const {
    return load_suite(folder_.path() / "out/suite.yaml").experiments[0].problems[number];
  }
};

const std::string far_away = "cuboid: {far: {dims: [0.1, 0.1, 0.1], pose: [9, 9, 9, 1, 0, 0, 0]}}";

/// A quarter turn about x, whose quaternion w, x, y, z is written in that order, lays each body along y. All
/// voxels of the map are asked for by the solids' own formulas.
TEST_F(Robometrics, SolidsAreTheVoxelsThatTheyMeet) {
  folder_.write("roof.obj", "v 0 0 0\nv 0.3 0 0\nv 0 0.3 0\nf 1 2 3\n");
  const CommandRun run = import_text(
      "cuboid:\n  plank: {dims: [0.08, 0.08, 0.68], pose: [3.05, 0.05, 0.05, 0.70710678, 0.70710678, 0, 0], "
      "color: [1, 0, 0, 1]}\n"
      "cylinder:\n  rod: {radius: 0.13, height: 0.4, pose: [3.05, 0.05, 1.05, 0.70710678, 0.70710678, 0, "
      "0]}\n"
      "sphere:\n  old: {radius: 0.22, position: [3.03, 0.05, 2.05]}\n"
      "  new: {radius: 0.17, pose: [3.05, 0.04, 3.05, 1, 0, 0, 0]}\n"
      "capsule:\n  pill: {radius: 0.12, base: [0, 0, 0.1], tip: [0, 0, 0.5], "
      "pose: [3.05, 0.05, 4.05, 0.70710678, 0.70710678, 0, 0]}\n"
      "mesh:\n  roof: {file_path: roof.obj, scale: [2, 2, 2], pose: [3.02, 0.03, 5.05, 1, 0, 0, 0]}\n"
      "  own: {vertices: [[0, 0, 0], [0.1, 0, 0], [0, 0.1, 0]], faces: [0, 1, 2], pose: [3.02, 0.03, 6.05, "
      "1, "
      "0, 0, 0]}\nblox: {map: {map_path: a.nvblx}}\n",
      {"--json"});
  ASSERT_EQ(run.status, exit_done) << run.log;
  const Json json = Json::parse(run.out);
  EXPECT_EQ(json["left_out"], Json{"set: its 'blox', which is a map of cuRobo's own"});
  const Snapshot made = map("set");
  // The least distance of a cube from what the body is a ball of: a point, a segment along y.
  const auto apart = [](const Eigen::Vector3d& cell, const Eigen::Vector3d& from, const Eigen::Vector3d& to) {
    Eigen::Vector3d gap;
    for (int i = 0; i < 3; ++i) gap[i] = std::max({0.0, from[i] - cell[i] - 0.05, cell[i] - 0.05 - to[i]});
    return gap;
  };
  std::size_t met = 0;
  for (int x = 26; x < 36; ++x)
    for (int y = -10; y < 10; ++y)
      for (int z = -4; z < 47; ++z) {
        const Eigen::Vector3d cell = 0.1 * (Eigen::Vector3d(x, y, z).array() + 0.5).matrix();
        const auto ball = [&](double cy, double cz, double half, double radius, double cx = 3.05) {
          return apart(cell, {cx, cy - half, cz}, {cx, cy + half, cz}).norm() <= radius;
        };
        const Eigen::Vector3d rod = apart(cell, {3.05, -0.15, 1.05}, {3.05, 0.25, 1.05});
        const bool expected = apart(cell, {3.01, -0.29, 0.01}, {3.09, 0.39, 0.09}).isZero(0.0) ||
                              (rod.y() == 0.0 && std::hypot(rod.x(), rod.z()) <= 0.13) ||
                              ball(0.05, 2.05, 0.0, 0.22, 3.03) || ball(0.04, 3.05, 0.0, 0.17) ||
                              ball(-0.25, 4.05, 0.2, 0.12);  // the turn takes z to -y
        EXPECT_EQ(made.state(cell) == VoxelState::occupied, expected) << cell.transpose();
        met += expected;
      }
  EXPECT_GT(met, 60U);
  EXPECT_EQ(made.state({3.65, 0.08, 5.05}), VoxelState::occupied);  // the corner of 0.3, twice
  EXPECT_EQ(made.state({3.75, 0.08, 5.05}), VoxelState::unknown);
  EXPECT_EQ(made.state({3.05, 0.05, 6.05}), VoxelState::occupied);
}

TEST_F(Robometrics, TheFirstFreeGoalOfGoalIkCounts) {
  const std::string text =
      "easy:\n- start: [0, 0, 0]\n  goal_ik:\n  - [0.5, 0, 0]\n  - [0.25, 0, 0]\n  obstacles:\n    ";
  ASSERT_EQ(import_text(text + far_away).status, exit_done);
  EXPECT_EQ(problem().goals[0], (std::vector<double>{0.5, 0.0, 0.0}));
  // What stands in the finger at the first goal.
  Robot robot = load_robot(robot_);
  const auto finger = std::find_if(robot.links.begin(), robot.links.end(),
                                   [](const Link& link) { return link.name == "finger"; });
  robot.tip_link = static_cast<int>(finger - robot.links.begin());
  Configuration first = Configuration::Zero(3);
  first[0] = 0.5;
  const Eigen::Vector3d tip = tip_pose(robot, first) * Eigen::Vector3d(0.1, 0.0, 0.0);
  std::ostringstream blocked;
  blocked << "sphere: {b: {radius: 0.02, position: [" << tip.x() << ", " << tip.y() << ", " << tip.z()
          << "]}}";
  resolution_ = "0.02";
  ASSERT_EQ(import_text(text + blocked.str()).status, exit_done);
  EXPECT_EQ(problem().goals[0], (std::vector<double>{0.25, 0.0, 0.0}));
  const Json record = Json::parse(read_file(folder_.file("out/import.json")));
  EXPECT_EQ(record["problems"][0]["goal"]["number"], 2);
  EXPECT_EQ(record["problems"][0]["name"], "easy 1");
}

TEST_F(Robometrics, AGoalPoseBecomesJointValuesThatReachIt) {
  const Robot robot = load_robot(robot_);
  Configuration there = Configuration::Zero(3);
  there << 0.4, -0.3, 0.0;
  const int finger = with_tip(robot, "finger").tip_link;
  const auto pose_of = [&](const Configuration& q) {
    return forward_kinematics(robot, q)[static_cast<std::size_t>(finger)];
  };
  const Eigen::Isometry3d pose = pose_of(there);
  const Eigen::Quaterniond turn(pose.linear());
  std::ostringstream text;
  text.precision(17);
  text << "nested:\n  deep:\n  - start: [0, 0, 0]\n    obstacles: {}\n    difficulty: 3\n    goal_pose:\n    "
          "  "
          "frame: my_finger\n      position_xyz: ["
       << pose.translation().x() << ", " << pose.translation().y() << ", " << pose.translation().z()
       << "]\n      quaternion_wxyz: [" << turn.w() << ", " << turn.x() << ", " << turn.y() << ", "
       << turn.z() << "]\n";
  const CommandRun run = import_text(text.str(), {"--json"});
  ASSERT_EQ(run.status, exit_done) << run.log;
  EXPECT_EQ(Json::parse(run.out)["poses"], 1);
  EXPECT_EQ(Json::parse(run.out)["left_out"], Json{"nested deep 1: 'difficulty'"});
  const std::vector<double> goal = problem().goals[0];
  ASSERT_EQ(goal.size(), 3U);
  EXPECT_TRUE(pose_of(Eigen::Map<const Configuration>(goal.data(), 3)).isApprox(pose, 1e-4));
}

/// Values of the joints that move the placed link: the others stand still.
TEST_F(Robometrics, ValuesWithoutTheFingersAreOfTheArm) {
  const std::string pose =
      "  goal_pose: {frame: finger, position_xyz: [0, 0, 9], quaternion_wxyz: [1, 0, 0, 0]}\n";
  const std::string arm = "a:\n- start: [0, 0.1]\n  goal_ik: [[0.5, -0.1]]\n  obstacles: {}\n";
  const CommandRun without = import_text(arm);
  EXPECT_EQ(without.status, exit_bad_input);
  EXPECT_NE(without.log.find("got 2 values, expected 3"), std::string::npos) << without.log;
  const Robot robot = load_robot(robot_);
  const auto moving = std::find_if(robot.links.begin(), robot.links.end(), [&](const Link& link) {
    return link.joint == 1;  // below both joints of the arm, above the grip
  });
  ASSERT_NE(moving, robot.links.end());
  std::string placed = pose;
  placed.replace(placed.find("finger"), 6, moving->name);
  const CommandRun run = import_text(arm + placed);
  ASSERT_EQ(run.status, exit_done) << run.log;
  EXPECT_EQ(problem().goals[0], (std::vector<double>{0.5, -0.1}));
  EXPECT_EQ(load_suite(folder_.path() / "out/suite.yaml").experiments[0].fixed.size(), 1U);
}

TEST_F(Robometrics, WhatWouldBeLostOrMisreadIsRefusedInOneSentence) {
  const std::string head = "a:\n- start: [0, 0, 0]\n  goal_ik: [[0.1, 0, 0]]\n";
  const std::vector<std::pair<std::string, std::string>> wrong{
      {head + "  obstacles: {cone: {c: {radius: 1}}}\n", "expected no such kind of obstacles"},
      {head + "  obstacles: {cuboid: {c: {dims: [1, 1], pose: [0, 0, 0, 1, 0, 0, 0]}}}\n",
       "dims: expected 3"},
      {head + "  obstacles: {cuboid: {c: {dims: [1, 1, 1], pose: [0, 0, 0, 1, 0, 0]}}}\n",
       "pose: expected 7"},
      {head + "  obstacles: {cuboid: {c: {dims: [1, 1, 1], pose: [0, 0, 0, 0, 0, 0, 0]}}}\n",
       "expected a unit quaternion w, x, y, z"},
      {head +
           "  obstacles: {cuboid: {c: {dims: [1, 1, 1], scale: [2, 1, 1], pose: [0, 0, 0, 1, 0, 0, 0]}}}\n",
       "cuRobo scales meshes alone"},
      {head + "  obstacles: {cuboid: {c: {dims: [1, 1, 1], yaw: 1, pose: [0, 0, 0, 1, 0, 0, 0]}}}\n",
       "yaw: expected no such key"},
      {head + "  obstacles: {sphere: {c: {radius: 1}}}\n", "expected a pose of seven numbers"},
      {head + "  obstacles: {mesh: {c: {file_path: no.stl, pose: [0, 0, 0, 1, 0, 0, 0]}}}\n", "no.stl"},
      {head + "  obstacles: {}\n  world_frame: table\n", "frame 'table', which is unknown"},
      {head + "  obstacles: {}\n  world_frame: finger\n", "frame 'finger', a link that moves"},
      {head, "expected a map of obstacles, or {}"},
      {"a:\n- start: [0, 0, 0]\n  obstacles: {}\n  goal_ik: [[0.1, 0]]\n", "expected 3 numbers"},
      {"a:\n- start: [0, 0, 0]\n  obstacles: {}\n", "it has neither goal_ik nor goal_pose"},
      {"a: 3\n", "a"}};
  for (const auto& [text, why] : wrong) {
    const CommandRun run = import_text(text);
    EXPECT_EQ(run.status, exit_bad_input) << text;
    EXPECT_TRUE(run.complains_in_one_sentence()) << run.log;
    EXPECT_NE(run.log.find(why), std::string::npos) << run.log;
  }
}

/// A pickle is a program: this one would make a file.
TEST_F(Robometrics, APickleIsNeverLoaded) {
  const std::string mark = folder_.file("ran");
  const std::string pickle = std::string("\x80\x03") + "cos\nsystem\n(Vtouch " + mark + "\ntR.";
  for (const char* kind : {"robometrics", "json", "mbm"}) {
    for (const char* name : {"set.pkl", "set.yaml"}) {
      const CommandRun run = import(kind, {folder_.write(name, pickle)});
      EXPECT_EQ(run.status, exit_bad_input);
      EXPECT_TRUE(run.complains_in_one_sentence()) << run.log;
      EXPECT_NE(run.log.find("a Python pickle, which is a program"), std::string::npos) << run.log;
    }
  }
  EXPECT_FALSE(std::filesystem::exists(mark));
}

TEST_F(Robometrics, OurExampleBecomesASuiteThatCompareSolves) {
  robot_ = "panda";
  resolution_ = "0.03";
  const CommandRun run =
      import("robometrics", {CLEARWAY_SOURCE_DIR "/datasets/suites/foreign/robometrics.yaml"}, {"--json"});
  ASSERT_EQ(run.status, exit_done) << run.log;
  const Json json = Json::parse(run.out);
  EXPECT_EQ(json["problems"], 2);
  EXPECT_EQ(json["poses"], 1);
  EXPECT_TRUE(json["left_out"].empty()) << json["left_out"];
  const CommandRun compared = run_command({"compare", "--worst-pages", "0", folder_.file("out/suite.yaml"),
                                           "--out", folder_.file("results"), "--planners", "rrtconnect"});
  EXPECT_EQ(compared.status, exit_done) << compared.log;
  EXPECT_NE(compared.out.find("2 / 2"), std::string::npos) << compared.out;
}

}  // namespace import_test
}  // namespace clearway
