// Keys that `clearway import mbm` refuses, and those that pass.
#include "datasets/yaml/message_keys.hpp"

#include "tests/apps/problem_sets/import_fixture.hpp"

namespace clearway {
namespace import_test {

class MessageKeys : public Import {
 protected:
  CommandRun run(const std::string& scene, const std::string& request = arm_request) {
    std::filesystem::remove_all(folder_ / "out");
    return import("mbm", {folder_.write("scene.yaml", scene), folder_.write("request.yaml", request)});
  }
  void expect_refused(const CommandRun& run, const std::string& path) {
    EXPECT_EQ(run.status, exit_bad_input) << path << ": " << run.out;
    EXPECT_TRUE(run.complains_in_one_sentence()) << run.log;
    EXPECT_NE(run.log.find(path + ": expected no such key, as what it says would be lost; known are "),
              std::string::npos)
        << run.log;
  }
};

std::string with_one_object(const std::string& fields) {
  return "world: {collision_objects: [{id: a, " + fields + "}]}";
}

const std::string one_ball = "primitives: [{type: 2, dimensions: [0.1]}]";
const std::string three_away = "{position: [3, 0, 0], orientation: [0, 0, 0, 1]}";

/// Each of them moved, turned or resized nothing, and the object stood at the origin, or as large as ever.
TEST_F(MessageKeys, OfAnObjectThatWouldMoveTurnOrResizeItAreRefused) {
  const std::string object = "world.collision_objects[0]";
  for (const std::string key : {"primitive_pose", "poses", "mesh_pose", "orientation", "position"})
    expect_refused(run(with_one_object(one_ball + ", " + key + ": " + three_away)), object + "." + key);
  for (const char* more : {"frame_id: upper", "scale: 2", "units: mm", "shapes: [1]"})
    expect_refused(run(with_one_object(one_ball + ", " + more)),
                   object + "." + std::string(more).substr(0, std::string(more).find(':')));
  const std::string placed = ", primitive_poses: [" + three_away + "]";
  for (const char* more : {"scale: [2, 2, 2]", "padding: 0.1", "pose: {position: [1, 0, 0]}"})
    expect_refused(run(with_one_object("primitives: [{type: 2, dimensions: [0.1], " + std::string(more) +
                                       "}]" + placed)),
                   object + ".primitives[0]." + std::string(more).substr(0, std::string(more).find(':')));
  expect_refused(
      run(with_one_object(one_ball + ", primitive_poses: [{position: [3, 0, 0], rpy: [0, 0, 1]}]")),
      object + ".primitive_poses[0].rpy");
  expect_refused(run(with_one_object(one_ball + ", primitive_poses: [{position: {X: 3}}]")),
                 object + ".primitive_poses[0].position.X");
  expect_refused(run(with_one_object(one_ball + ", header: {frame: upper}")), object + ".header.frame");
  const std::string mesh = "meshes: [{vertices: [[0, 0, 0], [1, 0, 0], [0, 1, 0]], triangles: [[0, 1, 2]], ";
  for (const std::string key : {"scale", "scaling", "mesh_scale"})
    expect_refused(run(with_one_object(mesh + key + ": [2, 2, 2]}], mesh_poses: [" + three_away + "]")),
                   object + ".meshes[0]." + key);
  expect_refused(run("collision_objects: [{id: a}]\n" + with_one_object(one_ball)), "collision_objects");
  expect_refused(run("robot_state: {attached_collision_objects: [{link_name: upper, object: {id: a, " +
                     one_ball + ", primitive_pose: " + three_away + "}}]}\nworld: {collision_objects: []}"),
                 "robot_state.attached_collision_objects[0].object.primitive_pose");
}

TEST_F(MessageKeys, OfARequestThatWouldConstrainItsGoalAreRefused) {
  const std::string scene = "world: {collision_objects: []}";
  const auto with_goal = [&](const std::string& goal) {
    return run(scene, "group_name: arm\ngoal_constraints: [{" + goal + "}]");
  };
  const std::string region = ", constraint_region: {" + one_ball + ", primitive_poses: [" + three_away + "]}";
  expect_refused(
      with_goal("position_constraints: [{link_name: lower, target_offset: [0, 0, 1]" + region + "}]"),
      "goal_constraints[0].position_constraints[0].target_offset");
  expect_refused(with_goal("position_constraints: [{link_name: lower, constraint_region: {" + one_ball +
                           ", primitive_pose: " + three_away + "}}]"),
                 "goal_constraints[0].position_constraints[0].constraint_region.primitive_pose");
  expect_refused(with_goal("joint_constraints: [{joint_name: elbow, position: 0, tolerance: 0.1}]"),
                 "goal_constraints[0].joint_constraints[0].tolerance");
  expect_refused(with_goal("joint_constraint: [{joint_name: elbow, position: 0}]"),
                 "goal_constraints[0].joint_constraint");
  expect_refused(run(scene, arm_request + "goal_constraint: [{joint_constraints: []}]\n"), "goal_constraint");
  expect_refused(run(scene, "start_state: {joint_states: {name: [elbow]}}\n" +
                                arm_request.substr(arm_request.find("group_name"))),
                 "start_state.joint_states");
}

/// All fields of the messages, as ROS 2 prints them, with notes of people between.
TEST_F(MessageKeys, OfTheMessagesThemselvesAndNotesPass) {
  const std::string header = "header: {seq: 0, stamp: {sec: 0, nanosec: 0}, frame_id: world}";
  const std::string pose =
      "{position: {x: 3.0, y: 0.0, z: 0.0}, orientation: {x: 0.0, y: 0.0, z: 0.0, w: 1.0}}";
  const std::string object =
      "{" + header + ", pose: " + pose +
      ", id: a, type: {key: '', db: ''}, primitives: [{type: 2, dimensions: [0.1], polygon: {points: []}}], "
      "primitive_poses: [" +
      pose + "], meshes: [], mesh_poses: [], planes: [{coef: [0.0, 0.0, 1.0, 9.0]}], plane_poses: [" + pose +
      "], subframe_names: [tip], subframe_poses: [" + pose +
      "], operation: 0, color: [1, 0, 0], comment: a ball, mass: 2, shape: ball}";
  const std::string state =
      "{joint_state: {" + header +
      ", name: [grip, elbow, shoulder], position: [0.02, 0.1, 0.0], velocity: [], effort: []}, "
      "multi_dof_joint_state: {" +
      header + ", joint_names: [], transforms: [], twist: [], wrench: []}, attached_collision_objects: [{" +
      "link_name: finger, object: " + object +
      ", touch_links: [], detach_posture: {joint_names: [], points: []}, weight: 0.0}], is_diff: false}";
  const CommandRun passed = run(
      "name: all\nrobot_state: " + state + "\nrobot_model_name: arm\nfixed_frame_transforms: [{" + header +
          ", child_frame_id: world, transform: {translation: {x: 0.0, y: 0.0, z: 0.0}, rotation: {x: 0.0, "
          "y: 0.0, z: 0.0, w: 1.0}}}]\nallowed_collision_matrix: {entry_names: [], entry_values: [], "
          "default_entry_names: [], default_entry_values: []}\nlink_padding: []\nlink_scale: []\n"
          "object_colors: []\nis_diff: false\nworld: {collision_objects: [" +
          object + "], octomap: {" + header + ", origin: " + pose + ", octomap: {" + header +
          ", binary: false, id: '', resolution: 0.0, data: []}}}\n",
      "workspace_parameters: {" + header + "}\nstart_state: " + state +
          "\ngoal_constraints: [{name: '', joint_constraints: [{joint_name: shoulder, position: 0.5, "
          "tolerance_above: 0.01, tolerance_below: 0.01, weight: 1.0}, {joint_name: elbow, position: -0.1}], "
          "position_constraints: [], orientation_constraints: [], visibility_constraints: []}]\n"
          "path_constraints: {name: ''}\ntrajectory_constraints: {constraints: []}\nreference_trajectories: "
          "[]\npipeline_id: ompl\nplanner_id: ''\ngroup_name: arm\nnum_planning_attempts: 1\n"
          "allowed_planning_time: 5.0\nmax_velocity_scaling_factor: 1.0\nmax_acceleration_scaling_factor: "
          "1.0\ncartesian_speed_end_effector_link: ''\ncartesian_speed_limited_link: ''\n"
          "max_cartesian_speed: 0.0\nseed: 3\nnotes: {author: me}\n");
  EXPECT_EQ(passed.status, exit_done) << passed.log;
}

}  // namespace import_test
}  // namespace clearway
