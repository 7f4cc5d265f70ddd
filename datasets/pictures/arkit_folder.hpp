#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "datasets/sources/recording.hpp"

namespace clearway {

/// True for poses as ARKitScenes has them: a `.traj` whose first line has seven numbers (TUM's have eight).
bool is_arkit_poses(const std::filesystem::path& file, const std::string& text);

/// ARKitScenes' poses as TUM text: from lines of a time (s), a rotation vector (rad) and a translation (m)
/// that lead from the world to the camera (x right, y down, z forward).
/// @throws std::invalid_argument naming `name` and the line
std::string tum_of_arkit(const std::string& text, const std::string& name);

/// The cameras of pictures, each by the file of the nearest time in a folder of `.pincam` (width, height, fx,
/// fy, cx, cy): the phone's focal length is not always the same.
/// @throws std::invalid_argument naming a file that is none, or a picture for which none is within a second
std::vector<CameraIntrinsics> cameras_of_arkit(const std::filesystem::path& folder,
                                               const std::vector<std::filesystem::path>& pictures);

}  // namespace clearway
