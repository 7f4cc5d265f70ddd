#pragma once

#include <string>
#include <vector>

#include "datasets/yaml/yaml_fields.hpp"

namespace clearway {

/// Whether a key would say where something is, how it is turned or how large it is.
bool tells_of_space(const std::string& key);

/// Messages of ROS and MoveIt whose keys are known.
enum class RosMessage {
  header,
  pose,
  transform,
  transform_stamped,
  planning_scene,
  scene_world,
  octomap_with_pose,
  octomap,
  robot_state,
  multi_dof_joint_state,
  attached_object,
  collision_object,
  primitive,
  mesh,  ///< with `resource` and `dimensions`, as Robowflex has them
  plane,
  plan_request,
  constraints,
  joint_constraint,
  position_constraint,
  orientation_constraint,
  region
};

/// Whether the message has some keys, all of them its own.
bool has_keys_of(const YamlFields& message, RosMessage kind);

/// Refuses keys that the message does not have and whose loss would move, turn, resize or free something:
/// misspelt ones, and those of other formats. Returns the other unknown keys, which pass: notes, names,
/// colours.
/// @throws std::invalid_argument naming the key and those that are known
std::vector<std::string> require_no_lost_keys(const YamlFields& message, RosMessage kind);

}  // namespace clearway
