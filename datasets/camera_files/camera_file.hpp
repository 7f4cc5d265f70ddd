#pragma once

#include <filesystem>
#include <optional>
#include <string>

#include "datasets/cameras/image_size.hpp"
#include "datasets/sources/recording.hpp"

namespace clearway {

/// A camera as other tools write it, from the text of
/// - kalibr's camchain (`cam0`, `cam1`, …: pinhole with radtan, equidistant or no distortion);
/// - ROS's camera_info (plumb_bob, rational_polynomial, equidistant or fisheye), or one CameraInfo as
///   `rostopic echo` or `ros2 topic echo` prints it;
/// - OpenCV's FileStorage as YAML, XML or JSON, by the names that people give the matrix (camera_matrix,
///   cameraMatrix, Camera_Matrix, K, or of two M1, …) and what belongs to it; five coefficients: plumb bob,
///   more: rational, `fisheye_model`: fisheye;
/// - EuRoC's sensor.yaml; camodocal's (VINS): PINHOLE and KANNALA_BRANDT;
/// - COLMAP's cameras.txt and cameras.bin (camera_of_colmap);
/// - nerfstudio's transforms.json, of pictures that have one camera (camera_of_nerf_file);
/// - librealsense's intrinsics as JSON (set_realsense_lens), Open3D's and Replica's, also inside other maps;
/// - a matrix alone (camera_of_matrix_text).
///
/// Pixels are counted alike in all of them. The camera of pictures that are rectified is that of ROS's
/// projection_matrix (rectified_camera); where it is not stated, and of others, the raw one if it is a
/// pinhole.
/// @param name what errors call the file
/// @param camera the one of a camchain, of a file of several maps or matrices; may be empty when there is one
/// @param size of its pictures, where it is known from elsewhere: OpenCV's files and matrices may leave it
/// out
/// @param lens of a file that names none, as OpenCV's are; it has to agree with one that does
/// @param note becomes one sentence without its end where the file may mean another lens
/// @throws std::invalid_argument in one sentence naming file, key and what was expected: omnidirectional
/// and other lenses, too, and no word of rectified pictures where there is need of one
CameraIntrinsics parse_camera_file(const std::string& text, const std::string& name,
                                   const std::string& camera, bool is_rectified = false,
                                   std::optional<ImageSize> size = {}, std::optional<LensModel> lens = {},
                                   std::string* note = nullptr);

/// The same from a file. @throws std::invalid_argument also when it cannot be read.
CameraIntrinsics load_camera_file(const std::filesystem::path& file, const std::string& camera,
                                  bool is_rectified = false, std::optional<ImageSize> size = {},
                                  std::optional<LensModel> lens = {}, std::string* note = nullptr);

/// m per step of depth pictures, by what a camera's file says beside: steps in a metre as `scale` of
/// Replica's cam_params.json, `m_depthShift` of an info.txt and `DepthMapFactor` or `RGBD.DepthMapFactor` of
/// ORB-SLAM's settings and `png_depth_scale` of gradslam and NICE-SLAM; `depth_scale` in a camera or beside
/// it, which is metres in a step (librealsense), steps in a metre (Open3D) or, from 0.01 to 10 beside `fx`
/// and `cx`, millimetres in a step (BOP's camera.json). Nothing: it says none. @param name the one of several
/// cameras
/// @throws std::invalid_argument when it cannot be read, or says what no camera has
std::optional<double> depth_scale_of_file(const std::filesystem::path& file, const std::string& name = "");

}  // namespace clearway
