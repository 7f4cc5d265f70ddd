#pragma once

#include <filesystem>
#include <optional>

#include "datasets/cameras/nerf_camera.hpp"
#include "datasets/pictures/camera_path.hpp"

namespace clearway {

/// Polycam's `keyframes/corrected_cameras/` or, where they were not optimised, `keyframes/cameras/` of a
/// folder; empty: there is none of its files of cameras.
std::filesystem::path polycam_cameras(const std::filesystem::path& keyframes);

/// The cameras of such a folder, a file for each picture, called as the picture is: `t_00` to `t_23`, row by
/// row, world_from_camera of a camera with x right, y up and z back, in ARKit's world, whose y points up;
/// `fx`, `fy`, `cx` and `cy` are of colour pictures of `width` x `height`, depth pictures are smaller in the
/// same ratio.
/// @param size of depth pictures; none: no shot has a camera
/// @throws std::invalid_argument in one sentence naming the file, the place and what was expected
CameraPath polycam_path(const std::filesystem::path& cameras, const std::optional<ImageSize>& size = {});

}  // namespace clearway
