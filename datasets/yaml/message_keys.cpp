#include "datasets/yaml/message_keys.hpp"

#include <algorithm>
#include <cctype>
#include <map>
#include <set>
#include <span>

#include "mapping/system/plain_text.hpp"

namespace clearway {
namespace {

using Names = std::set<std::string>;

/// As moveit_msgs, shape_msgs, geometry_msgs, octomap_msgs and std_msgs of ROS 1 and 2 have them.
const Names& keys_of(RosMessage kind) {
  static const std::map<RosMessage, Names> known{
      {RosMessage::header, {"seq", "stamp", "frame_id"}},
      {RosMessage::pose, {"position", "orientation"}},
      {RosMessage::transform, {"translation", "rotation"}},
      {RosMessage::transform_stamped, {"header", "child_frame_id", "transform"}},
      {RosMessage::planning_scene,
       {"name", "robot_state", "robot_model_name", "fixed_frame_transforms", "allowed_collision_matrix",
        "link_padding", "link_scale", "object_colors", "world", "is_diff"}},
      {RosMessage::scene_world, {"collision_objects", "octomap"}},
      {RosMessage::octomap_with_pose, {"header", "origin", "octomap"}},
      {RosMessage::octomap, {"header", "binary", "id", "resolution", "data"}},
      {RosMessage::robot_state,
       {"joint_state", "multi_dof_joint_state", "attached_collision_objects", "is_diff"}},
      {RosMessage::multi_dof_joint_state, {"header", "joint_names", "transforms", "twist", "wrench"}},
      {RosMessage::attached_object, {"link_name", "object", "touch_links", "detach_posture", "weight"}},
      {RosMessage::collision_object,
       {"header", "pose", "id", "type", "primitives", "primitive_poses", "meshes", "mesh_poses", "planes",
        "plane_poses", "subframe_names", "subframe_poses", "operation"}},
      {RosMessage::primitive, {"type", "dimensions", "polygon"}},
      {RosMessage::mesh, {"triangles", "vertices", "resource", "dimensions"}},
      {RosMessage::plane, {"coef"}},
      {RosMessage::plan_request,
       {"workspace_parameters", "start_state", "goal_constraints", "path_constraints",
        "trajectory_constraints", "reference_trajectories", "pipeline_id", "planner_id", "group_name",
        "num_planning_attempts", "allowed_planning_time", "max_velocity_scaling_factor",
        "max_acceleration_scaling_factor", "cartesian_speed_end_effector_link",
        "cartesian_speed_limited_link", "max_cartesian_speed"}},
      {RosMessage::constraints,
       {"name", "joint_constraints", "position_constraints", "orientation_constraints",
        "visibility_constraints"}},
      {RosMessage::joint_constraint,
       {"joint_name", "position", "tolerance_above", "tolerance_below", "weight"}},
      {RosMessage::position_constraint,
       {"header", "link_name", "target_point_offset", "constraint_region", "weight"}},
      {RosMessage::orientation_constraint,
       {"header", "orientation", "link_name", "absolute_x_axis_tolerance", "absolute_y_axis_tolerance",
        "absolute_z_axis_tolerance", "parameterization", "weight"}},
      {RosMessage::region, {"primitives", "primitive_poses", "meshes", "mesh_poses"}}};
  return known.at(kind);
}

bool has_part(const std::string& key, std::span<const char* const> parts) {
  std::string word;
  for (const char c : key) word += static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
  return std::any_of(parts.begin(), parts.end(),
                     [&](const char* part) { return word.find(part) != std::string::npos; });
}

/// Whether a list or map of this name would be of things, states or constraints.
bool tells_of_things(const std::string& key) {
  static const char* const telling[] = {"primit", "mesh",   "scal",  "plane", "shape", "solid", "octomap",
                                        "object", "obstac", "state", "joint", "goal",  "start", "constraint",
                                        "attach", "bod",    "box",   "spher", "cylin", "cone"};
  return has_part(key, telling);
}

bool tells_of_tolerance(const std::string& key) {
  static const char* const telling[] = {"toler", "padd", "region", "xyz"};
  return has_part(key, telling);
}

/// Words that hold such letters and say nothing of space.
bool is_note(const std::string& key) {
  static const char* const notes[] = {"repositor", "purpose",   "compos",   "database", "protocol",
                                      "prototype", "framework", "communit", "transpar", "expos",
                                      "propos",    "timestamp", "dispos"};
  return has_part(key, notes);
}

}  // namespace

bool tells_of_space(const std::string& key) {
  static const char* const telling[] = {
      "orient", "rot",   "quat",   "euler",  "rpy",  "angle", "yaw",   "pose",   "pos",  "center", "centre",
      "origin", "trans", "offset", "frame",  "axis", "size",  "dim",   "extent", "radi", "length", "height",
      "width",  "depth", "scale",  "matrix", "unit", "base",  "locat", "coord",  "diam", "thick",  "inflat"};
  const bool is_axis = key.size() == 1 && std::string_view("xyz").find(key) != std::string_view::npos;
  return is_axis || (has_part(key, telling) && !is_note(key));
}

bool has_keys_of(const YamlFields& message, RosMessage kind) {
  const std::vector<std::string> keys = message.keys();
  return !keys.empty() && std::all_of(keys.begin(), keys.end(),
                                      [&](const std::string& key) { return keys_of(kind).contains(key); });
}

std::vector<std::string> require_no_lost_keys(const YamlFields& message, RosMessage kind) {
  const Names& known = keys_of(kind);
  std::vector<std::string> passed;
  for (const std::string& key : message.keys()) {
    if (known.contains(key) || !message.has(key)) continue;
    const bool is_composed = message.is_map(key) || message.is_list(key);
    if (is_composed && message.is_empty(key)) continue;
    if (tells_of_space(key) || tells_of_tolerance(key) || (is_composed && tells_of_things(key)))
      message.fail(key, "expected no such key, as what it says would be lost; known are " +
                            listed({known.begin(), known.end()}));
    passed.push_back(key);
  }
  return passed;
}

}  // namespace clearway
