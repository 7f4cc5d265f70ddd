#pragma once

#include <filesystem>
#include <optional>
#include <string>

#include "datasets/cameras/image_size.hpp"
#include "datasets/pictures/picture_poses.hpp"
#include "datasets/sources/recording.hpp"

namespace clearway {

/// The poses of Stray Scanner's odometry.csv, world_from_camera (x right, y down, z forward): a head that
/// names x, y, z, qx, qy, qz and qw, perhaps behind a time and `frame`, the number of the picture. Nothing
/// for another text. @throws std::invalid_argument naming `name` and the line
std::optional<NumberedPoses> parse_stray_poses(const std::string& text, const std::string& name);

/// The camera of depth pictures of this size by Stray Scanner's camera_matrix.csv, which is that of the video
/// of 1920 x 1440 pixels. @throws std::invalid_argument when it is none
CameraIntrinsics stray_camera(const std::filesystem::path& file, const ImageSize& size);

}  // namespace clearway
