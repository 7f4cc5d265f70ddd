#pragma once

#include <filesystem>
#include <map>
#include <set>
#include <string>

#include "apps/problem_sets/problem_set.hpp"
#include "planning/robot_files/mesh_file.hpp"

namespace clearway {

/// What scene files are read with.
struct SceneContext {
  Robot robot = {};                            ///< whole; its links are frames
  std::set<std::string> planning_frames = {};  ///< what the SRDF calls the map
  PackageFolders packages = {};                ///< of meshes
  bool leaves_unknown_frames = false;          ///< what stands in one is left out, and not refused
  double plane_reach = 3.0;                    ///< m, see plane_triangles
};

enum class SceneFileKind { scene, request, neither };

/// What a file of YAML is: a scene has `world`, a motion request has `goal_constraints` or `start_state`.
/// @throws std::invalid_argument when it is no map of YAML.
SceneFileKind kind_of_scene_file(const std::string& text, const std::filesystem::path& file);

/// Reads a planning scene as YAML, of ROS messages (moveit_msgs/PlanningScene) or as MotionBenchMaker and
/// Robowflex write them: world.collision_objects of primitives, meshes and planes, world.octomap, and what
/// its robot_state has in the hand. An object that is added again replaces the one of its name, one that is
/// moved takes its pieces along, one that is removed goes, all as MoveIt has it. Frames are
/// those of SceneFrames, with the robot as robot_state says, and what `fixed_frame_transforms` states.
/// Moves and removals of what is not there, planes and octomaps that links may touch, paddings and scales
/// of links, and the name of another robot are left out, and reported; so is what stands in an unknown frame,
/// where the context allows it.
/// @throws std::invalid_argument in one sentence naming file, line, field and what was expected.
ForeignWorld read_planning_scene(const std::string& text, const std::filesystem::path& file,
                                 const SceneContext& context, std::vector<std::string>& left_out);

/// Reads a motion request (moveit_msgs/MotionPlanRequest) of a scene, whose frames it uses, with the links
/// where its own start has them: start_state with what it has in the hand (all of
/// it, or, of a diff, in place of and beside what the scene has there), group_name, and of each goal its
/// joint constraints with their tolerances, and the position and orientation constraints of one link. These
/// become a pose, of a position in any of several regions a goal for each, with tolerances that lie within
/// what the constraints allow: of a region the ball about its middle, of the tolerances about the axes the
/// least, and a free axis for one of pi. Path constraints and other goals are left out, and reported; without
/// any goal `goals` is empty.
ForeignProblem read_motion_request(const std::string& text, const std::filesystem::path& file,
                                   const SceneContext& context, const ForeignWorld& scene,
                                   std::vector<std::string>& left_out);

/// Reads MoveIt's text of a scene (.scene), both of its forms: with and without poses of objects.
/// @throws std::invalid_argument in one sentence naming file, line and what was expected.
ForeignWorld read_scene_text(const std::string& text, const std::filesystem::path& file,
                             const SceneContext& context);

/// Reads the JSON of problem sets: problems.NAME[] with lists `sphere`, `cylinder`, `box`, and `start`,
/// `goals`, `valid`, `index`; values are those of the problem's `joint_names`, of the file's `joints` (as
/// VAMP writes them), else in the robot's order. A solid's turn is `orientation_quat_xyzw` (or
/// `quaternion_xyzw`), `…_wxyz`, or angles about the fixed axes x, y, z as `orientation_euler_xyz` or `rpy`;
/// other keys that speak of its place or size are refused, and the rest is left out. One world and problem
/// each; experiments are called NAME. Problems that say `valid: false` are left out.
/// @throws std::invalid_argument in one sentence naming file, field and what was expected.
ForeignSet read_problem_json(const std::string& text, const std::filesystem::path& file);

/// Reads the YAML or JSON of robometrics and cuRobo: NAME, or NAME within NAME, to a list of problems of
/// `obstacles`, `start`, `goal_ik` and `goal_pose`, each one world and one problem; or one cuRobo world,
/// which has no problem. Obstacles are `cuboid` (dims), `cylinder` (radius, height), `sphere` (radius; pose
/// or position), `capsule` (radius, base, tip) and `mesh` (file_path, or vertices and faces; scale) by their
/// names; poses are x, y, z and a quaternion w, x, y, z. The goals are those of `goal_ik`, in the robot's
/// order, and then `goal_pose`. `world_frame` is a link that no joint moves. Left out, and reported: `blox`
/// and `voxel`, and keys that nobody knows; other kinds of obstacles are refused.
/// @throws std::invalid_argument in one sentence naming file, line, field and what was expected.
ForeignSet read_robometrics(const std::string& text, const std::filesystem::path& file,
                            const SceneContext& context);

}  // namespace clearway
