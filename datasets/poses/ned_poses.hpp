#pragma once

#include <filesystem>
#include <string>

#include "datasets/poses/numbered_poses.hpp"

namespace clearway {

/// True for poses as TartanAir has them: a file called pose_left.txt, pose_right.txt, pose_lcam_front.txt, …
/// whose first line has seven numbers.
bool is_ned_poses(const std::filesystem::path& file, const std::string& text);

/// TartanAir's poses (castacks/tartanair_tools, data_type.md): a line `tx ty tz qx qy qz qw` for each picture
/// from 0, world_from_camera of a camera with x forward, y right and z down, m. They are given back of the
/// optical frame (x right, y down, z forward), in the same world.
/// @throws std::invalid_argument naming `name`, the line and what was expected
NumberedPoses parse_ned_poses(const std::string& text, const std::string& name);

}  // namespace clearway
