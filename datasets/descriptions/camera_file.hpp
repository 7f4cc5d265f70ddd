#pragma once

#include <filesystem>
#include <string>

#include "datasets/sources/recording.hpp"

namespace clearway {

/// A camera as other tools write it, from YAML text: kalibr's camchain (`cam0`, `cam1`, …: pinhole with
/// radtan, equidistant or no distortion) or ROS's camera_info (plumb_bob, rational_polynomial, equidistant or
/// fisheye). `name` is what errors call the file; `camera` the one of a camchain, may be empty when there is
/// one. Also OpenCV's calibrations of the same keys in YAML (five coefficients: plumb bob, more: rational,
/// `fisheye_model`: fisheye) and one CameraInfo as `rostopic echo` or `ros2 topic echo` prints it. Pixels are
/// counted alike in all three. The camera of pictures that are rectified is that of ROS's projection_matrix
/// (rectified_camera); where it is not stated, and of kalibr, the raw one if it is a pinhole.
/// @throws std::invalid_argument in one sentence naming file, key and what was expected: omnidirectional
/// and other lenses, too, and no word of rectified pictures where there is need of one
CameraIntrinsics parse_camera_file(const std::string& text, const std::string& name,
                                   const std::string& camera, bool is_rectified = false);

/// The same from a file. @throws std::invalid_argument also when it cannot be read.
CameraIntrinsics load_camera_file(const std::filesystem::path& file, const std::string& camera,
                                  bool is_rectified = false);

}  // namespace clearway
