#pragma once

#include <string>

#include "datasets/sources/recording.hpp"

namespace clearway {

/// What the info.txt of BundleFusion, 12-Scenes, ScanNet and 3RScan says: lines `m_depthWidth = 640`.
struct SensorInfo {
  CameraIntrinsics depth, colour;  ///< without distortion
  double steps_per_metre = 0.0;    ///< of depth
};

bool is_sensor_info(const std::string& text);

/// @param name what errors call the file
/// @throws std::invalid_argument in one sentence that names the line that is missing or no number
SensorInfo parse_sensor_info(const std::string& text, const std::string& name);

}  // namespace clearway
