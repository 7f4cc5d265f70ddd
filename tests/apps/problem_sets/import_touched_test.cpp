// Objects that links may touch: allowed_collision_matrix of a scene.
#include <gtest/gtest.h>

#include <filesystem>

#include "datasets/descriptions/suite.hpp"
#include "tests/apps/problem_sets/import_fixture.hpp"

namespace clearway {
namespace import_test {

/// An arm whose finger is a ball of 5 cm at (0.9, 0, 0) at the start, and a mug that it touches there.
class ImportTouched : public Import {
 protected:
  /// How many of its one problem are valid, where these may touch the mug, or the shelf beside it.
  int valid(const std::string& names, const std::string& values, const std::string& mug) {
    std::filesystem::remove_all(folder_ / "out");
    resolution_ = "0.02";
    const std::string matrix = names.empty() ? ""
                                             : "allowed_collision_matrix: {entry_names: " + names +
                                                   ", entry_values: " + values + "}\n";
    const std::string scene = folder_.write(
        "scene.yaml", "robot_state: {joint_state: {name: [shoulder, elbow, grip], position: [0, 0, 0]}}\n" +
                          matrix + "world: {collision_objects: [{id: mug, " + mug +
                          "}, {id: shelf, primitives: [{type: box, dimensions: [0.1, 0.1, 0.1]}], "
                          "primitive_poses: [{position: [0.6, -0.6, 0]}]}]}\n");
    const std::string request = folder_.write(
        "request.yaml",
        "goal_constraints: [{joint_constraints: [{joint_name: shoulder, position: 1}, {joint_name: elbow, "
        "position: 0}]}]");
    const CommandRun run = import("mbm", {scene, request}, {"--json"});
    EXPECT_EQ(run.status, exit_done) << run.log;
    left_out_ = Json::parse(run.out)["left_out"].dump();
    return compared(folder_)["valid"].get<int>();
  }
  std::string left_out_;
};

const std::string sphere =
    "primitives: [{type: sphere, dimensions: [0.03]}], primitive_poses: [{position: [0.93, 0, 0]}]";
const std::string both = "[[false, true], [true, false]]";

TEST_F(ImportTouched, ALinkThatMayTouchAnObjectDoesAndOthersDoNot) {
  EXPECT_EQ(valid("", "", sphere), 0);
  EXPECT_EQ(map("scene").state({0.93, 0.0, 0.0}), VoxelState::occupied);
  EXPECT_EQ(valid("[finger, mug]", both, sphere), 1);
  EXPECT_EQ(left_out_, "[]");
  EXPECT_EQ(map("scene").state({0.93, 0.0, 0.0}), VoxelState::unknown);
  EXPECT_EQ(map("scene").state({0.6, -0.6, 0.0}), VoxelState::occupied);
  const SuiteProblem problem = load_suite(folder_ / "out/suite.yaml").experiments[0].problems[0];
  ASSERT_EQ(problem.loads.size(), 1U);
  EXPECT_EQ(problem.loads[0].link, "base");
  EXPECT_EQ(problem.loads[0].touches, std::vector<std::string>{"finger"});
  EXPECT_TRUE(problem.loads[0].link_from_load.translation().isApprox(Eigen::Vector3d(0.93, 0.0, 0.0), 1e-9));
  // One side of the matrix alone permits nothing: MoveIt reads one of them.
  EXPECT_EQ(valid("[finger, mug]", "[[false, true], [false, false]]", sphere), 0);
  EXPECT_EQ(valid("[finger, mug]", "[[false, false], [true, false]]", sphere), 0);
  EXPECT_EQ(map("scene").state({0.93, 0.0, 0.0}), VoxelState::occupied);
  // The arm beside it may touch it, the finger may not.
  EXPECT_EQ(valid("[upper, mug]", both, sphere), 0);
  EXPECT_EQ(left_out_, "[]");
  // The mug stands on the way of the upper arm, which the finger's permission does not cover.
  EXPECT_EQ(
      valid(
          "[finger, mug]", both,
          "primitives: [{type: sphere, dimensions: [0.03]}], primitive_poses: [{position: [0.15, 0.15, 0]}]"),
      0);
  EXPECT_EQ(
      valid(
          "[upper, mug]", both,
          "primitives: [{type: sphere, dimensions: [0.03]}], primitive_poses: [{position: [0.15, 0.15, 0]}]"),
      1);
}

TEST_F(ImportTouched, WhatIsNoLinkAndPlanesAreListed) {
  EXPECT_EQ(valid("[ghost, mug]", both, sphere), 0);
  EXPECT_NE(left_out_.find("1 pairs with an object that may collide, the first 'mug' with 'ghost'"),
            std::string::npos)
      << left_out_;
  EXPECT_EQ(valid("[finger, mug]", both, "planes: [{coef: [0, 0, 1, 0.01]}], plane_poses: [{}]"), 0);
  EXPECT_NE(left_out_.find("'mug' with 'finger'"), std::string::npos) << left_out_;
}

/// The links that may touch it are those of a suite's problems, of which there are none.
TEST_F(ImportTouched, WithoutARequestAnObjectThatMayBeTouchedIsInTheMap) {
  resolution_ = "0.02";
  const std::string scene = folder_.write(
      "scene.yaml", "allowed_collision_matrix: {entry_names: [finger, mug], entry_values: " + both +
                        "}\nworld: {collision_objects: [{id: mug, " + sphere + "}]}\n");
  const CommandRun run = import("mbm", {scene}, {"--json"});
  ASSERT_EQ(run.status, exit_done) << run.log;
  EXPECT_EQ(map("scene").state({0.93, 0.0, 0.0}), VoxelState::occupied);
  EXPECT_NE(Json::parse(run.out)["left_out"].dump().find("which links may touch mug"), std::string::npos)
      << run.out;
}

TEST_F(ImportTouched, WithoutAProblemThatIsLeftAnObjectThatMayBeTouchedIsInTheMap) {
  const std::string scene = "allowed_collision_matrix: {entry_names: [finger, mug], entry_values: " + both +
                            "}\nworld: {collision_objects: [{id: mug, " + sphere + "}]}\n";
  const auto request = [](const std::string& goal) {
    return "start_state: {joint_state: {name: [shoulder, elbow, grip], position: [0, 0, 0]}}\n"
           "goal_constraints: [{" +
           goal + "}]";
  };
  const CommandRun run = import(
      "mbm",
      {folder_.write("scene0001.yaml", scene), folder_.write("scene0002.yaml", scene),
       folder_.write(
           "request0001.yaml",
           request("position_constraints: [{link_name: finger, constraint_region: {primitives: "
                   "[{type: sphere, dimensions: [0.01]}], primitive_poses: [{position: [9, 0, 0]}]}}]")),
       folder_.write("request0002.yaml",
                     request("joint_constraints: [{joint_name: shoulder, position: 1}, {joint_name: elbow, "
                             "position: 0}]"))},
      {"--json"});
  ASSERT_EQ(run.status, exit_done) << run.log;
  EXPECT_EQ(Json::parse(run.out)["problems"], 1) << run.out;
  EXPECT_EQ(map("scene0001").state({0.93, 0.0, 0.0}), VoxelState::occupied) << run.out;
  EXPECT_EQ(map("scene0002").state({0.93, 0.0, 0.0}), VoxelState::unknown);
}

}  // namespace import_test
}  // namespace clearway
