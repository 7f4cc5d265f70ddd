#pragma once

#include <Eigen/Geometry>
#include <filesystem>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "apps/problem_sets/planning_scene.hpp"
#include "datasets/yaml/yaml_fields.hpp"

namespace clearway {

// What messages of ROS, as YAML, have in common. Vectors and quaternions are lists or maps of x, y, z, w.

/// [x, y, z] or {x: …, y: …, z: …}; a coordinate that is left out is 0. @param names "xyz" or "xyzw"
Eigen::VectorXd ros_coordinates(const YamlFields& fields, const std::string& key, const std::string& names);

/// A unit quaternion; none where the key is left out, or all four numbers are 0, as ROS writes it.
Eigen::Matrix3d ros_turn(const YamlFields& fields, const std::string& key);

/// geometry_msgs/Pose: position and orientation.
Eigen::Isometry3d ros_pose(const YamlFields& pose);

/// geometry_msgs/Transform: translation and rotation.
Eigen::Isometry3d ros_transform(const YamlFields& transform);

/// A word; empty when it is left out, or written as ROS writes an empty one: ''.
std::string ros_word(const YamlFields& fields, const std::string& key);

/// Whether a word says yes: true, True, 1.
bool ros_truth(const std::string& word);

/// What a moveit_msgs/CollisionObject's `operation` asks for: "add", the default, "remove", "append" or
/// "move", or what else stands there. Written as such a word in letters of any size, as its number from 0, or
/// as the character of that number.
std::string ros_operation(const YamlFields& object);

/// header.frame_id without a leading slash; empty when it is left out.
std::string ros_frame(const YamlFields& fields);

/// Joint values of a moveit_msgs/RobotState.
std::map<std::string, double> ros_joints(const YamlFields& state);

/// Where a moveit_msgs/RobotState places the robot's root link: its only joint of several degrees of freedom.
struct RosBase {
  std::string frame;  ///< in which it stands; empty: the planning frame
  Eigen::Isometry3d pose;
};

/// None: it does not say. @throws std::invalid_argument where it has several such joints and moves one
std::optional<RosBase> ros_base(const YamlFields& state);

/// @throws std::invalid_argument naming the state when it places the base otherwise than these frames do.
void require_base_of(const SceneFrames& frames, const YamlFields& state);

/// shape_msgs/SolidPrimitive: box x, y, z; sphere radius; cylinder and cone height, radius.
void read_primitive(const YamlFields& primitive, ForeignSolid& solid);

/// Poses under `key`, one for each of `count` pieces; a single piece may have none.
std::vector<Eigen::Isometry3d> ros_poses(const YamlFields& fields, const std::string& key, std::size_t count);

/// The triangles of the mesh file that `key` names, corners three by three. @param folder that it is relative
/// to @throws std::invalid_argument naming the key when it cannot be read.
std::vector<Eigen::Vector3d> mesh_of_file(const YamlFields& mesh, const std::string& key,
                                          const Eigen::Vector3d& scale, const PackageFolders& packages,
                                          const std::filesystem::path& folder);

/// The same of a list of points and one of triangles of indices into it.
std::vector<Eigen::Vector3d> mesh_of_lists(const YamlFields& mesh, const std::string& vertex_key,
                                           const std::string& triangle_key);

/// Primitives and meshes of a moveit_msgs/CollisionObject. @param frame_from_object the object's own pose
/// included @param folder that files of meshes are relative to
std::vector<ForeignSolid> ros_solids(const YamlFields& object, const std::string& name,
                                     const Eigen::Isometry3d& frame_from_object,
                                     const PackageFolders& packages, const std::filesystem::path& folder);

/// attached_collision_objects of a moveit_msgs/RobotState.
struct RosAttached {
  std::vector<ForeignAttached> added;    ///< those without shapes have no pieces
  std::vector<ForeignDetached> removed;  ///< by their operation
  std::vector<std::string> left_out;     ///< those with another operation
};

/// @param folder that files of meshes are relative to
RosAttached ros_attached(const YamlFields& state, const PackageFolders& packages,
                         const std::filesystem::path& folder);

/// A body whose message names no frame stands in the planning frame: gives its pieces poses in the map.
void place_in_map(const SceneFrames& frames, ForeignAttached& body);

/// Gives the pieces of a body poses in the frame of its link, where both the link and the body's frame stand
/// in the map; else in the map, where the frame alone does. A frame of a link whose place is unknown stays.
/// @return a sentence's end that says what is wrong with the frame, empty: nothing
std::string put_on_link(const SceneFrames& frames, ForeignAttached& body);

/// How to go on where a frame is unknown, for sentences.
extern const std::string or_leave_out_frames;

}  // namespace clearway
