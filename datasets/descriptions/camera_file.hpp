#pragma once

#include <filesystem>
#include <string>

#include "datasets/sources/recording.hpp"

namespace clearway {

/// A camera as other tools write it, from YAML text: kalibr's camchain (`cam0`, `cam1`, …: pinhole with
/// radtan, equidistant or no distortion) or ROS's camera_info (plumb_bob, rational_polynomial, equidistant or
/// fisheye). `name` is what errors call the file; `camera` the one of a camchain, may be empty when there is
/// one. Pixels are counted alike in all three.
/// @throws std::invalid_argument in one sentence naming file, key and what was expected: omnidirectional
/// and other lenses, too
CameraIntrinsics parse_camera_file(const std::string& text, const std::string& name,
                                   const std::string& camera);

/// The same from a file. @throws std::invalid_argument also when it cannot be read.
CameraIntrinsics load_camera_file(const std::filesystem::path& file, const std::string& camera);

}  // namespace clearway
