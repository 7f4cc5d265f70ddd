#pragma once

#include <filesystem>
#include <map>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "planning/robot/robot.hpp"
#include "planning/robot_files/urdf_file.hpp"

namespace clearway {

/// A number for all joints, and others for some by name.
struct PerJoint {
  std::optional<double> all;
  std::map<std::string, double> by_name;
};

/// What the .yaml beside a URDF adds to it. All lengths are of the full-size robot of the URDF.
struct RobotSettings {
  std::string description;
  std::filesystem::path urdf;  ///< empty: the file of the same stem
  double scale = 1.0;          ///< the robot is this many times as large as the URDF's
  Eigen::Isometry3d map_from_base = Eigen::Isometry3d::Identity();
  std::string tip_link;  ///< empty: the last link of the longest branch
  Eigen::Isometry3d link_from_tip = Eigen::Isometry3d::Identity();
  std::vector<std::string> critical_parts;
  PerJoint friction;          ///< mu_j of Chong et al. 2008, eq. 8; default 0.1
  PerJoint step;              ///< epsilon_j in rad or m; default 0.5 deg or 0.01 m
  PerJoint max_acceleration;  ///< rad/s^2 or m/s^2, above 0; none: Joint::max_acceleration stays 0
  PerJoint max_jerk;          ///< rad/s^3 or m/s^3, the same
  double position_accuracy = default_position_accuracy;
  std::string inverse_kinematics = "numeric";
  std::optional<std::vector<std::pair<std::string, std::string>>> exempt;  ///< pairs of parts
  std::filesystem::path srdf;                ///< beside the settings; empty: the URDF's name
  std::string group;                         ///< planning group of the SRDF; empty: all joints
  std::map<std::string, double> fixed;       ///< joints that stand still, rad or m
  std::vector<std::string> standing;         ///< links on such joints that may touch what the robot stands on
  std::map<std::string, std::string> xacro;  ///< arguments of the .xacro
  MeshPieces mesh_pieces{};
};

/// Reads a robot's .yaml. @throws std::invalid_argument naming file, key and what was expected; an unknown
/// key is an error that names the nearest known one.
RobotSettings read_robot_settings(const std::filesystem::path& file);

/// True for .urdf and .xacro.
bool is_urdf_name(const std::filesystem::path& file);

/// The file of that extension beside a URDF: of "arm.urdf" and of "arm.urdf.xacro" it is "arm" + extension.
std::filesystem::path beside_urdf(const std::filesystem::path& urdf, const std::string& extension);

/// The URDF of a robot that is loaded from `file`, a .urdf or a .yaml with these settings.
std::filesystem::path urdf_of(const std::filesystem::path& file, const RobotSettings& settings);

/// The same of a robot that was loaded from a file.
std::filesystem::path urdf_of_robot(const Robot& robot);

/// Puts the settings into a full-size robot as read from the URDF; scaling and exemptions come afterwards.
/// @throws std::invalid_argument for a joint, link or part that the robot does not have.
void apply_settings(const RobotSettings& settings, const std::filesystem::path& file, Robot& robot);

}  // namespace clearway
