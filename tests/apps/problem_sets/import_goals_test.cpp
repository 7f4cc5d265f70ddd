// `clearway import` of goals of poses, of several goals and of what is in the hand.
#include <gtest/gtest.h>

#include <cmath>
#include <nlohmann/json.hpp>

#include "datasets/descriptions/suite.hpp"
#include "planning/robot/kinematics.hpp"
#include "planning/robot_files/load_robot.hpp"
#include "tests/apps/problem_sets/import_fixture.hpp"

namespace clearway {
namespace import_test {

const std::string panda_names =
    "[panda_joint1, panda_joint2, panda_joint3, panda_joint4, panda_joint5, panda_joint6, panda_joint7]";
const std::string panda_start = "start_state: {joint_state: {name: " + panda_names +
                                ", position: [0, -0.3, 0, -2.2, 0, 2.0, 0.785]}}\ngroup_name: panda_arm\n";

/// A cup held upright may turn about its axis; where the straight pose is, a post stands in the way of the
/// arm, so that the free configuration is one turned or another branch.
TEST_F(Import, AGoalOfAPoseBecomesTheFreeConfigurationNearestToTheStart) {
  robot_ = "panda";
  resolution_ = "0.05";
  const Robot panda = load_robot("panda");
  const std::string scene = folder_.write(
      "scene0001.yaml",
      "world: {collision_objects: [{id: post, primitives: [{type: box, dimensions: [0.1, 0.1, 1]}], "
      "primitive_poses: [{position: [0.7, 0.5, 0.5]}]}]}");
  const std::string request = folder_.write(
      "request0001.yaml",
      panda_start +
          "goal_constraints:\n"
          "  - position_constraints:\n"
          "      - link_name: panda_hand\n        target_point_offset: {z: 0.1}\n"
          "        constraint_region:\n          primitives: [{type: 2, dimensions: [0.01]}]\n"
          "          primitive_poses: [{position: {x: 0.4, y: -0.3, z: 0.4}}]\n"
          "    orientation_constraints:\n"
          "      - {link_name: panda_hand, orientation: {x: 1}, absolute_x_axis_tolerance: 0.05,\n"
          "         absolute_y_axis_tolerance: 0.05, absolute_z_axis_tolerance: 6.28}\n");
  const CommandRun run = import("mbm", {scene, request}, {"--json"});
  ASSERT_EQ(run.status, exit_done) << run.log;
  const Json said = Json::parse(run.out);
  EXPECT_EQ(said["poses"], 1);
  EXPECT_EQ(said["left_out"], Json::array());

  const Suite suite = load_suite(folder_ / "out/suite.yaml");
  const std::vector<double> goal = suite.experiments[0].problems[0].goals[0];
  const auto link = std::find_if(panda.links.begin(), panda.links.end(),
                                 [](const Link& known) { return known.name == "hand"; });
  ASSERT_NE(link, panda.links.end());
  Configuration q = Configuration::Zero(static_cast<Eigen::Index>(panda.dof()));
  for (std::size_t j = 0; j < goal.size(); ++j) q[static_cast<Eigen::Index>(j)] = goal[j];
  const Eigen::Isometry3d hand =
      forward_kinematics(panda, q)[static_cast<std::size_t>(link - panda.links.begin())];
  EXPECT_LE((hand * Eigen::Vector3d(0, 0, 0.1) - Eigen::Vector3d(0.4, -0.3, 0.4)).norm(), 0.01 + 1e-5);
  EXPECT_GE(-hand.linear()(2, 2), std::cos(0.05) - 1e-5);  // its z axis points down
  const Json entry = Json::parse(read_file(folder_.file("out/import.json")))["problems"][0]["goal"];
  EXPECT_EQ(entry["link"], "hand");
  EXPECT_EQ(entry["free"], true);
  EXPECT_EQ(entry["free_axis"], "z");
  EXPECT_EQ(compared(folder_)["valid"], 1);
}

/// Both fingers of a gripper stand in MoveIt's requests, though one follows the other.
TEST_F(Import, JointsThatMimicOthersAreTakenByTheseWhereTheyAgree) {
  std::string urdf = worlds::arm_with_finger();
  urdf.insert(urdf.rfind("</robot>"),
              worlds::urdf_link("second", "0.1 0 0", "<sphere radius='0.01'/>") +
                  worlds::urdf_joint("follow", "prismatic", "lower", "second", "0.4 0.2 0", "1 0 0",
                                     worlds::urdf_limit(0, 0.1) + "<mimic joint='grip'/>"));
  robot_ = folder_.write("arm.urdf", urdf);
  const std::string scene = folder_.write("scene.yaml", "world: {collision_objects: []}");
  const auto goal_of = [&](const std::string& fingers) {
    std::filesystem::remove_all(folder_.path() / "out");
    return import("mbm", {scene, folder_.write("request.yaml", arm_request + fingers)}, {"--json"});
  };
  const std::string second = "      - {joint_name: follow, position: ";
  for (const std::string& fingers :
       {second + "0.03}\n", "      - {joint_name: grip, position: 0.03}\n" + second + "0.0302}\n"}) {
    const CommandRun run = goal_of(fingers);
    ASSERT_EQ(run.status, exit_done) << run.log;
    const SuiteProblem problem = load_suite(folder_ / "out/suite.yaml").experiments[0].problems[0];
    EXPECT_EQ(problem.goals[0].back(), 0.03) << run.out;
  }
  const CommandRun apart = goal_of("      - {joint_name: grip, position: 0.01}\n" + second + "0.03}\n");
  EXPECT_EQ(apart.status, exit_bad_input);
  EXPECT_NE(apart.log.find("which follows 'grip' and stands at 0.01"), std::string::npos) << apart.log;
}

TEST_F(Import, APoseOutOfReachOrOfALinkThatIsNoneLeavesTheProblemOut) {
  robot_ = "panda";
  const std::string scene = folder_.write("scene.yaml", "world: {collision_objects: []}");
  const auto request = [&](const std::string& link, double x) {
    return folder_.write("request.yaml",
                         panda_start + "goal_constraints: [{position_constraints: [{link_name: " + link +
                             ", constraint_region: {primitives: [{type: sphere, dimensions: [0.01]}], "
                             "primitive_poses: [{position: [" +
                             std::to_string(x) + ", 0, 0.5]}]}}]}]");
  };
  const CommandRun far = import("mbm", {scene, request("panda_hand", 3.0)});
  EXPECT_EQ(far.status, exit_bad_input);
  EXPECT_NE(far.log.find("problem 'request': its goal: no configuration of robot 'panda'"), std::string::npos)
      << far.log;
  EXPECT_FALSE(std::filesystem::exists(folder_ / "out"));
  const CommandRun wrong = import("mbm", {scene, request("panda_hnd", 0.5)});
  EXPECT_EQ(wrong.status, exit_bad_input);
  EXPECT_NE(wrong.log.find("problem 'request': its goal names link 'panda_hnd', which robot 'panda' does not "
                           "have, did you mean 'hand'?"),
            std::string::npos)
      << wrong.log;
  const CommandRun near = import("mbm", {scene, request("panda_hand", 0.5)});
  EXPECT_EQ(near.status, exit_done) << near.log;
  EXPECT_NE(near.out.find("1, 1 of them to a pose, as joint values"), std::string::npos) << near.out;
}

/// The arm in its plane, reaching to x = 0.8 at zero; a ball stands where its second link would be at +0.5.
TEST_F(Import, OfSeveralGoalsTheFirstThatIsFreeIsChosen) {
  const std::string scene = folder_.write(
      "scene.yaml",
      "world: {collision_objects: [{id: ball, primitives: [{type: sphere, dimensions: [0.05]}], "
      "primitive_poses: [{position: [0.527, 0.288, 0]}]}]}");
  const auto goal = [](double shoulder) {
    return "{joint_constraints: [{joint_name: shoulder, position: " + std::to_string(shoulder) +
           "}, {joint_name: elbow, position: 0}]}";
  };
  const std::string request =
      folder_.write("request.yaml",
                    "start_state: {joint_state: {name: [shoulder, elbow, grip], position: [-1, 0, 0]}}\n"
                    "goal_constraints: [" +
                        goal(0.5) + ", " + goal(-0.5) + ", " + goal(-0.7) + "]");
  const CommandRun run = import("mbm", {scene, request}, {"--json"});
  ASSERT_EQ(run.status, exit_done) << run.log;
  EXPECT_EQ(Json::parse(run.out)["left_out"], Json::array());
  EXPECT_EQ(load_suite(folder_ / "out/suite.yaml").experiments[0].problems[0].goals,
            (std::vector<std::vector<double>>{{-0.5, 0.0}}));
  EXPECT_EQ(Json::parse(read_file(folder_.file("out/import.json")))["problems"][0]["goal"],
            (Json{{"number", 2}, {"of", 3}, {"free", true}}));
  EXPECT_EQ(load_suite(folder_ / "out/suite.yaml").experiments[0].padding, 0.0);

  // The ball of the upper arm, 0.2 along it, is 0.325 m from the corner (0.4, 0.2) of the occupied voxels at
  // the second goal, and 0.36 m at the third.
  std::filesystem::remove_all(folder_ / "out");
  ASSERT_EQ(import("mbm", {scene, request}, {"--padding", "0.34"}).status, exit_done);
  const Suite padded = load_suite(folder_ / "out/suite.yaml");
  EXPECT_EQ(padded.experiments[0].problems[0].goals, (std::vector<std::vector<double>>{{-0.7, 0.0}}));
  EXPECT_EQ(padded.experiments[0].padding, 0.34);

  std::filesystem::remove_all(folder_ / "out");
  ASSERT_EQ(import("mbm", {scene, request}, {"--padding", "auto"}).status, exit_done);
  EXPECT_FALSE(load_suite(folder_ / "out/suite.yaml").experiments[0].padding.has_value());

  std::filesystem::remove_all(folder_ / "out");
  const std::string sets =
      folder_.write("sets.json",
                    "{\"problems\": {\"a\": [{\"start\": [-1, 0, 0], \"goals\": [[0.5, 0, 0], [-0.5, 0, 0]], "
                    "\"sphere\": [{\"position\": [0.527, 0.288, 0], \"radius\": 0.05}]}]}}");
  ASSERT_EQ(import("json", {sets}).status, exit_done);
  EXPECT_EQ(load_suite(folder_ / "out/suite.yaml").experiments[0].problems[0].goals,
            (std::vector<std::vector<double>>{{-0.5, 0.0, 0.0}}));
}

/// MoveIt takes any goal of a request; one that the robot cannot have does not take the others along.
TEST_F(Import, AGoalOfAnotherRobotLosesNoLaterGoal) {
  const std::string scene = folder_.write("scene.yaml", "world: {}");
  const auto joints = [](const std::string& shoulder) {
    return "{joint_constraints: [{joint_name: " + shoulder +
           ", position: 0.5}, {joint_name: elbow, position: 0.1}]}";
  };
  const std::string region = "constraint_region: {primitives: [{type: sphere, dimensions: [0.01]}]}";
  const std::string request = folder_.write(
      "request.yaml",
      "start_state: {joint_state: {name: [shoulder, elbow, grip], position: [-1, 0, 0]}}\n"
      "goal_constraints: [" +
          joints("wheel") + ", {position_constraints: [{link_name: lowr, " + region +
          "}]}, {joint_constraints: [{joint_name: elbow, position: 0.2}]}, " + joints("shoulder") + "]");
  const CommandRun run = import("mbm", {scene, request}, {"--json"});
  ASSERT_EQ(run.status, exit_done) << run.log;
  const Json left = Json::parse(run.out)["left_out"];
  ASSERT_EQ(left.size(), 3U) << left;
  EXPECT_NE(left[0].dump().find("names joint 'wheel', which robot 'arm' does not have"), std::string::npos);
  EXPECT_NE(left[1].dump().find("names link 'lowr', which robot 'arm' does not have, did you mean 'lower'?"),
            std::string::npos);
  EXPECT_NE(left[2].dump().find("its goal has joint 'shoulder' at 0.5, which does not move and stands at -1"),
            std::string::npos)
      << "the first goal left names the elbow alone";
  const SuiteExperiment experiment = load_suite(folder_ / "out/suite.yaml").experiments[0];
  EXPECT_EQ(experiment.problems[0].goals, (std::vector<std::vector<double>>{{0.2}}));
}

/// As in a scene: the cup stands in the world of another problem, and its weight is the load's mass.
TEST_F(Import, WhatARequestAttachesByNameAloneLeavesTheWorldOfThatProblem) {
  const std::string scene =
      folder_.write("scene.yaml",
                    "world: {collision_objects: [{id: cup, primitives: [{type: sphere, dimensions: [0.01]}], "
                    "primitive_poses: [{position: [0.05, -1.05, 0.05]}]}]}");
  const std::string goal =
      "goal_constraints: [{joint_constraints: [{joint_name: shoulder, position: -0.4}, {joint_name: elbow, "
      "position: 0}]}]";
  const std::string state =
      "joint_state: {name: [shoulder, elbow, grip], position: [-1.5707963267948966, 0, 0]}";
  const std::string with =
      folder_.write("a.yaml", "start_state: {" + state +
                                  ", attached_collision_objects: [{link_name: lower, touch_links: "
                                  "[finger], weight: 0.75, object: {id: cup}}]}\n" +
                                  goal);
  const std::string without = folder_.write("b.yaml", "start_state: {" + state + "}\n" + goal);
  const CommandRun run = import("mbm", {scene, with, without}, {"--json"});
  ASSERT_EQ(run.status, exit_done) << run.log;
  EXPECT_EQ(Json::parse(run.out)["left_out"], Json::array());
  const std::vector<SuiteProblem> problems = load_suite(folder_ / "out/suite.yaml").experiments[0].problems;
  ASSERT_EQ(problems.size(), 2U);
  const Eigen::Vector3d cup(0.05, -1.05, 0.05);
  EXPECT_EQ(map(problems[0].world).state(cup), VoxelState::unknown);
  EXPECT_EQ(map(problems[1].world).state(cup), VoxelState::occupied);
  ASSERT_EQ(problems[0].loads.size(), 1U);
  EXPECT_TRUE(problems[1].loads.empty());
  EXPECT_EQ(problems[0].loads[0].mass, 0.75);
  const Eigen::Vector3d in_hand = problems[0].loads[0].link_from_load.translation();
  EXPECT_TRUE(in_hand.isApprox(Eigen::Vector3d(0.65, 0.05, 0.05), 1e-9)) << in_hand.transpose();
}

/// A rod in the hand reaches 0.4 m beyond it and meets what the arm alone does not.
TEST_F(Import, WhatIsInTheHandIsALoadThatCountsForTheGoalAndThePath) {
  resolution_ = "0.02";
  const std::string scene = folder_.write(
      "scene.yaml",
      "robot_state:\n  joint_state: {name: [shoulder, elbow, grip], position: [-1, 0, 0]}\n"
      "  attached_collision_objects:\n"
      "    - link_name: lower\n      touch_links: [finger]\n      object: {id: rod}\n"
      "allowed_collision_matrix: {entry_names: [rod, upper], entry_values: [[false, true], [true, false]]}\n"
      "world:\n  collision_objects:\n"
      "    - id: ball\n      primitives: [{type: sphere, dimensions: [0.04]}]\n"
      "      primitive_poses: [{position: [1.15, 0.05, 0]}]\n"
      "    - id: rod\n      primitives: [{type: box, dimensions: [0.4, 0.02, 0.02]}]\n"
      "      primitive_poses: [{position: [0.5403, -0.8415, 0], orientation: [0, 0, -0.479426, "
      "0.877583]}]\n");
  const std::string request = folder_.write(
      "request.yaml",
      "goal_constraints: [{joint_constraints: [{joint_name: shoulder, position: 0.04}, {joint_name: elbow, "
      "position: 0}]}, {joint_constraints: [{joint_name: shoulder, position: -0.4}, {joint_name: elbow, "
      "position: 0.2}]}]");
  const CommandRun run = import("mbm", {scene, request}, {"--json"});
  ASSERT_EQ(run.status, exit_done) << run.log;
  EXPECT_EQ(Json::parse(run.out)["left_out"], Json::array());
  EXPECT_EQ(map("scene").state({0.5403, -0.8415, 0.0}), VoxelState::unknown);  // it left the world
  const SuiteProblem problem = load_suite(folder_ / "out/suite.yaml").experiments[0].problems[0];
  ASSERT_EQ(problem.loads.size(), 1U);
  EXPECT_EQ(problem.loads[0].name, "rod");
  EXPECT_EQ(problem.loads[0].touches, (std::vector<std::string>{"finger", "upper"}));
  EXPECT_TRUE(
      problem.loads[0].link_from_load.isApprox(Eigen::Isometry3d(Eigen::Translation3d(0.6, 0, 0)), 1e-4))
      << problem.loads[0].link_from_load.matrix();
  EXPECT_EQ(problem.goals, (std::vector<std::vector<double>>{{-0.4, 0.2}}));  // the first meets the ball
  EXPECT_EQ(compared(folder_)["valid"], 1);
}

/// The names of what is in the hand: a scene has a rod and a cup there, a request says more of it.
class ImportHand : public Import {
 protected:
  std::vector<std::string> loads(const std::string& start_state) {
    std::filesystem::remove_all(folder_ / "out");
    const auto body = [](const std::string& name) {
      return "{link_name: lower, touch_links: [finger], object: {id: " + name +
             ", header: {frame_id: lower}, primitives: [{type: box, dimensions: [0.02, 0.02, 0.02]}], "
             "primitive_poses: [{position: [0.5, 0, 0]}]}}";
    };
    const std::string scene =
        folder_.write("scene.yaml",
                      "robot_state: {joint_state: {name: [shoulder, elbow, grip], position: [-1, 0, 0]}, "
                      "attached_collision_objects: [" +
                          body("rod") + ", " + body("cup") + "]}\nworld: {collision_objects: []}");
    const std::string request = folder_.write(
        "request.yaml", start_state +
                            "goal_constraints: [{joint_constraints: [{joint_name: shoulder, position: 0.4}, "
                            "{joint_name: elbow, position: 0}]}]");
    const CommandRun run = import("mbm", {scene, request}, {"--json"});
    EXPECT_EQ(run.status, exit_done) << run.log;
    left_out_ = Json::parse(run.out)["left_out"];
    std::vector<std::string> names;
    suite_ = load_suite(folder_ / "out/suite.yaml");
    for (const LoadSetup& load : suite_.experiments[0].problems[0].loads) names.push_back(load.name);
    return names;
  }

  Json left_out_;
  Suite suite_;
};

/// moveit_msgs/RobotState: is_diff says "whether or not to clear the attached bodies … before updating".
TEST_F(ImportHand, OfASceneStaysWhereTheStartStateIsADiffOrSaysNothing) {
  using Names = std::vector<std::string>;
  const std::string joints = "joint_state: {name: [shoulder], position: [-0.9]}";
  EXPECT_EQ(loads(""), (Names{"rod", "cup"}));
  EXPECT_EQ(loads("start_state: {is_diff: false, joint_state: {name: [], position: []}}\n"),
            (Names{"rod", "cup"}));
  EXPECT_EQ(loads("start_state: {is_diff: True, " + joints + "}\n"), (Names{"rod", "cup"}));
  EXPECT_EQ(left_out_, Json::array());
  EXPECT_EQ(loads("start_state: {is_diff: False, " + joints + "}\n"), Names{});
  EXPECT_EQ(left_out_.size(), 2U);
  EXPECT_EQ(left_out_[0],
            "request: attached body 'rod' of its scene, as its start_state is no diff and has other "
            "bodies, or none");
}

TEST_F(ImportHand, IsEmptiedByTheOperationRemove) {
  using Names = std::vector<std::string>;
  const auto removed = [](const std::string& name, const std::string& operation,
                          const std::string& link = "''") {
    return "start_state: {is_diff: true, attached_collision_objects: [{link_name: " + link +
           ", object: {id: " + name + ", operation: " + operation + "}}]}\n";
  };
  EXPECT_EQ(loads(removed("rod", "1")), Names{"cup"});
  EXPECT_EQ(loads(removed("cup", "remove")), Names{"rod"});
  EXPECT_EQ(loads(removed("''", "\"\\x01\"", "lower")), Names{});
  EXPECT_EQ(loads(removed("''", "1", "upper")), (Names{"rod", "cup"}));
  EXPECT_EQ(left_out_, Json::array());
  EXPECT_EQ(loads(removed("cup", "3")), (Names{"rod", "cup"}));
  EXPECT_EQ(left_out_, Json{"request.yaml: attached body 'cup', which is not added (operation 'move')"});
}

/// Robowflex writes bodies in the frame of the world: here 0.5 m beyond the elbow of the arm, which points
/// along -y.
TEST_F(ImportHand, OfARequestMayBeInAFrameThatStandsStill) {
  for (const char* frame : {"world", "/world", "base", "''"}) {
    const std::string half_pi = std::to_string(std::acos(0.0));
    EXPECT_EQ(loads("start_state: {joint_state: {name: [shoulder, elbow, grip], position: [-" + half_pi +
                    ", 0, 0]}, attached_collision_objects: [{link_name: lower, object: {id: pin, header: "
                    "{frame_id: " +
                    frame +
                    "}, primitives: [{type: sphere, dimensions: [0.01]}], primitive_poses: [{position: [0, "
                    "-0.9, 0]}]}}]}\n"),
              std::vector<std::string>{"pin"})
        << frame << left_out_;
    const Eigen::Isometry3d& pose = suite_.experiments[0].problems[0].loads.at(0).link_from_load;
    EXPECT_TRUE(pose.translation().isApprox(Eigen::Vector3d(0.5, 0, 0), 1e-5)) << frame << pose.matrix();
  }
}

/// A request's own hand counts before the scene's, and shapes of all kinds are read by `compare`.
TEST_F(Import, ShapesOfAllKindsInTheHandAreReadBack) {
  const std::string scene = folder_.write(
      "scene.yaml",
      "robot_state: {attached_collision_objects: [{link_name: lower, object: {id: thing, primitives: [{type: "
      "sphere, dimensions: [5]}]}}]}\nworld: {collision_objects: []}");
  const std::string request = folder_.write(
      "request.yaml",
      "start_state:\n  joint_state: {name: [shoulder, elbow, grip], position: [-1, 0, 0]}\n"
      "  attached_collision_objects:\n    - link_name: lower\n      touch_links: [finger]\n      object:\n"
      "        id: thing\n        header: {frame_id: lower}\n        pose: {position: [0.4, 0, 0]}\n"
      "        primitives:\n"
      "          - {type: box, dimensions: [0.02, 0.03, 0.04]}\n"
      "          - {type: sphere, dimensions: [0.02]}\n"
      "          - {type: cylinder, dimensions: [0.05, 0.01]}\n"
      "          - {type: cone, dimensions: [0.05, 0.01]}\n"
      "        primitive_poses: [{}, {position: [0, 0, 0.05]}, {position: [0, 0.05, 0]}, {}]\n"
      "        meshes: [{vertices: [[0, 0, 0], [0.02, 0, 0], [0, 0.02, 0]], triangles: [[0, 1, 2]]}]\n"
      "goal_constraints: [{joint_constraints: [{joint_name: shoulder, position: 0.4}, {joint_name: elbow, "
      "position: 0}]}]");
  const CommandRun run = import("mbm", {scene, request});
  ASSERT_EQ(run.status, exit_done) << run.log;
  const SuiteProblem problem = load_suite(folder_ / "out/suite.yaml").experiments[0].problems[0];
  std::vector<std::string> names;
  for (const LoadSetup& load : problem.loads) names.push_back(load.name);
  EXPECT_EQ(names, (std::vector<std::string>{"thing", "thing-2", "thing-3", "thing-4", "thing-5"}));
  EXPECT_EQ(std::get<LoadBox>(problem.loads[0].shape).edges, Eigen::Vector3d(0.02, 0.03, 0.04));
  EXPECT_EQ(std::get<LoadSphere>(problem.loads[1].shape).radius, 0.02);
  EXPECT_EQ(std::get<LoadCylinder>(problem.loads[2].shape).length, 0.05);
  EXPECT_EQ(std::get<LoadHull>(problem.loads[3].shape).points.size(), 65U);
  EXPECT_EQ(std::get<LoadHull>(problem.loads[4].shape).points.size(), 3U);
  EXPECT_EQ(compared(folder_)["valid"], 1);
}

/// A ball of 600 corners in the hand of each of 120 problems: `compare` reads at most 250,000 words of a
/// file.
TEST_F(Import, MeshesInTheHandOfManyProblemsAreWrittenOnce) {
  std::string mesh = "solid ball\n";
  std::vector<Eigen::Vector3d> corners;
  for (int i = 0; i < 600; ++i) {
    const double z = 1.0 - (2.0 * i + 1.0) / 600.0, turn = 2.4 * i, radius = std::sqrt(1.0 - z * z);
    corners.emplace_back(0.1 * radius * std::cos(turn), 0.1 * radius * std::sin(turn), 0.1 * z);
  }
  for (std::size_t i = 0; i + 2 < corners.size(); i += 3) {
    mesh += "facet normal 0 0 1\nouter loop\n";
    for (std::size_t k = i; k < i + 3; ++k)
      mesh += "vertex " + std::to_string(corners[k].x()) + " " + std::to_string(corners[k].y()) + " " +
              std::to_string(corners[k].z()) + "\n";
    mesh += "endloop\nendfacet\n";
  }
  folder_.write("ball.stl", mesh + "endsolid ball\n");
  Arguments files{folder_.write("scene.yaml", "world: {collision_objects: []}")};
  for (int i = 0; i < 120; ++i)
    files.push_back(folder_.write(
        "request" + std::to_string(i) + ".yaml",
        "start_state: {joint_state: {name: [shoulder, elbow, grip], position: [-1, 0, 0]}, "
        "attached_collision_objects: [{link_name: lower, touch_links: [finger], object: {id: ball, header: "
        "{frame_id: lower}, meshes: [{resource: ball.stl}]}}]}\ngoal_constraints: [{joint_constraints: "
        "[{joint_name: shoulder, position: 0.4}, {joint_name: elbow, position: 0}]}]"));
  const CommandRun run = import("mbm", files, {"--json"});
  ASSERT_EQ(run.status, exit_done) << run.log;
  EXPECT_EQ(Json::parse(run.out)["left_out"], Json::array());
  const std::vector<SuiteProblem> problems = load_suite(folder_ / "out/suite.yaml").experiments[0].problems;
  ASSERT_EQ(problems.size(), 120U);
  for (const SuiteProblem& problem : {problems.front(), problems.back()}) {
    const auto& points = std::get<LoadHull>(problem.loads.at(0).shape).points;
    ASSERT_EQ(points.size(), 600U);
    for (const Eigen::Vector3d& point : points) {
      double nearest = 1.0;
      for (const Eigen::Vector3d& corner : corners) nearest = std::min(nearest, (corner - point).norm());
      EXPECT_LT(nearest, 2e-6) << point.transpose();
    }
  }
  EXPECT_EQ(std::distance(std::filesystem::directory_iterator(folder_ / "out/hulls"), {}), 1);
}

/// The SRDF names a link that the robot does not have: import says so, and so does compare of the suite.
TEST_F(Import, NotesOnTheSrdfAreToldByImportAndCompare) {
  folder_.write("arm.srdf",
                "<robot name='other'><disable_collisions link1='base' link2='gone' reason='Never'/></robot>");
  const std::string set =
      folder_.write("a.json", R"({"problems": {"a": [{"start": [0, 0, 0], "goals": [[0.1, 0.1, 0]]}]}})");
  const CommandRun run = import("json", {set});
  ASSERT_EQ(run.status, exit_done) << run.log;
  const CommandRun compared = run_command(
      {"compare", "--worst-pages", "0", folder_.file("out/suite.yaml"), "--out", folder_.file("results")});
  for (const std::string& told : {run.log, compared.log + compared.out}) {
    EXPECT_NE(told.find("is for robot 'other', the URDF's robot is called 'arm'"), std::string::npos) << told;
    EXPECT_NE(told.find("names 1 link in pairs without a test that the robot does not have: gone"),
              std::string::npos)
        << told;
  }
}

}  // namespace import_test
}  // namespace clearway
