#pragma once

#include <filesystem>
#include <string>
#include <utility>
#include <vector>

#include "planning/robot/robot.hpp"

namespace clearway {

/// Loads a robot. `name_or_path` is a name in datasets/robots (a .yaml there: urdf, scale, tip, critical
/// parts, friction, steps, exempt pairs, inverse kinematics) or the path of a .yaml or .urdf; for a .urdf a
/// .srdf and a .yaml of the same stem beside it are honoured.
/// Meshes (DAE, OBJ, PLY, STL through assimp) become their convex hulls; package:// is searched upwards.
/// @throws std::invalid_argument in one sentence naming file and element: no joints, NaN, bodies of no size,
///         axis zero, lower > upper, loops, misspelt names, numbers that no robot has, ...
/// @throws DamagedFile when a mesh file is not whole or has no usable geometry.
Robot load_robot(const std::string& name_or_path);

/// Names in datasets/robots with one line of description each, sorted.
std::vector<std::pair<std::string, std::string>> available_robots();

/// The folder of robots, scenes, setups and suites: $CLEARWAY_DATASETS; else ../share/clearway beside the
/// running program's own folder, if that holds robots; else where `cmake --install` was configured to put it;
/// else /usr/share/clearway.
/// @throws std::invalid_argument when $CLEARWAY_DATASETS holds no folder of robots.
std::filesystem::path datasets_folder();

}  // namespace clearway
