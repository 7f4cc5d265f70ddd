#pragma once

#include <filesystem>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "datasets/cameras/camera_shots.hpp"
#include "datasets/cameras/nerf_camera.hpp"

namespace clearway {

/// Whether a text begins as such a file does, with `{`.
bool is_camera_path(const std::string& text);

/// - transforms.json of nerfstudio and instant-ngp: `frames`, each with `file_path`, possibly
///   `depth_file_path`, and `transform_matrix`, from a camera with x right, y up and z back. `fl_x`, `fl_y`,
///   `cx`, `cy`, `w`, `h`, `k1`, `k2`, `p1`, `p2` and `camera_angle_x` of a frame come before those of the
///   file. A pixel's middle is at 0.5 there, at 0 here.
/// - Open3D's PinholeCameraTrajectory: `parameters`, each with `extrinsic`, camera_from_world column by
///   column, and `intrinsic`.
/// - BOP's scene_camera.json: by the picture's number `cam_K` (row by row), `depth_scale` (mm per step) and,
///   not in all of them, `cam_R_w2c` (row by row) and `cam_t_w2c` (mm), camera_from_world.
/// - Record3D's metadata.json and ScanNet++'s pose_intrinsic_imu.json (phone_paths.hpp).
/// @param name what errors call the file @param sizes of pictures, for a file that does not say it: lengths
/// in pixels are of colour pictures, angles of any; without sizes such a file states no camera
/// @throws std::invalid_argument in one sentence naming the file, the place and what was expected
CameraPath parse_camera_path(const std::string& text, const std::string& name,
                             const std::optional<PictureSizes>& sizes = {});

/// The shot of each of these depth pictures that has one: by its number; by the file that it names as its
/// depth or, where none does, by a picture whose name differs by words such as "depth" and "color" alone;
/// without names, each in its order. @param file where the path is from @param pictures in the order of names
/// @throws std::invalid_argument naming `file` when they cannot be matched, or a picture has two shots
std::map<std::filesystem::path, CameraShot> shots_of_pictures(
    const CameraPath& path, const std::filesystem::path& file,
    const std::vector<std::filesystem::path>& pictures);

}  // namespace clearway
