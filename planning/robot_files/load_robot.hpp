#pragma once

#include <filesystem>
#include <map>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "planning/robot/robot.hpp"
#include "planning/robot_files/mesh_file.hpp"

namespace clearway {

/// A robot as a user asks for it.
struct RobotRequest {
  std::string robot;             ///< name or path, as load_robot(name_or_path) takes it
  std::filesystem::path srdf{};  ///< empty: the settings' (`srdf:`), else the one beside the URDF, if any
  std::string group{};  ///< planning group of the SRDF; empty: the settings' (`group:`), else all joints
  std::map<std::string, double> fixed{};  ///< joints that stand still, rad or m at full size
  /// Folders of packages that meshes name (package://NAME/…); others are looked for as find_mesh says.
  std::map<std::string, std::filesystem::path> packages{};
  std::map<std::string, std::string> xacro{};  ///< arguments of a .xacro, before the settings' (`xacro:`)
  std::vector<std::string>
      standing{};  ///< links on held joints, as wheels; beside the settings' (`standing:`)
  /// States of the SRDF: what they say of joints outside of the group, and `fixed` does not, stands there.
  std::vector<std::string> fixed_states{};
  /// Of the joints that would be held (load_robot), those that are not: a recording says where they were.
  std::set<std::string> moving{};
};

/// Loads a robot. Joints that `fixed`, `fixed_states` or the settings' `fixed:` name and, when a group is
/// chosen, all outside of it are no part of configurations (Robot::held): they stand at that value, else
/// where the SRDF's state "default" puts them, else at 0 clamped into their limits. Their bodies still count.
/// Those of `moving` are part of configurations all the same, and the tip is where it is without them.
/// The tip is the settings', else the parent link of the end effector on the group, else the tip of its
/// chain, else where the joints of the group have it, or all joints (place_tip).
/// @throws as load_robot(name_or_path); std::invalid_argument for a group without a SRDF or that it does not
///         define, a fixed joint that is none or out of its limits, states that contradict each other, xacro
///         arguments of a file that is none, or a standing link that is none or that a joint of
///         configurations moves.
Robot load_robot(const RobotRequest& request);

/// Loads a robot. `name_or_path` is a name in datasets/robots (a .yaml there: urdf, scale, tip, critical
/// parts, friction, steps, exempt pairs, inverse kinematics, srdf, group, fixed, standing, xacro) or the path
/// of a .yaml or .urdf; for a .urdf a .srdf and a .yaml of the same stem beside it are honoured. Meshes (DAE,
/// OBJ, PLY, STL through assimp) become their convex hulls; package:// is searched upwards.
/// @throws std::invalid_argument in one sentence naming file and element: no joints, NaN, bodies of no size,
///         axis zero, lower > upper, loops, misspelt names, numbers that no robot has, ...
/// @throws DamagedFile when a mesh file is not whole or has no usable geometry.
Robot load_robot(const std::string& name_or_path);

/// What makes one doubt that its files are meant so: srdf_notes, xacro_notes, and sizes and limits as they
/// are of millimetres and degrees. @throws as these
std::vector<std::string> robot_notes(const Robot& robot, const PackageFolders& packages = {});

/// Names in datasets/robots with one line of description each, sorted.
std::vector<std::pair<std::string, std::string>> available_robots();

/// The folder of robots, scenes, setups and suites: $CLEARWAY_DATASETS; else share/clearway in a folder above
/// the library that holds this code, where the program has loaded one (the Python module); else
/// ../share/clearway beside the running program's own folder, if that holds robots; else that of the package
/// that find_package(clearway) gave the program; else where `cmake --install` was configured to put it; else
/// /usr/share/clearway.
/// @throws std::invalid_argument when $CLEARWAY_DATASETS holds no folder of robots.
std::filesystem::path datasets_folder();

}  // namespace clearway
