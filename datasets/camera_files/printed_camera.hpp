#pragma once

#include "datasets/sources/recording.hpp"
#include "datasets/yaml/yaml_fields.hpp"

namespace clearway {

/// Whether it is a CameraInfo as it is printed, which says more of its K than OpenCV's users do.
bool is_printed_camera(const YamlFields& file);

/// What `rostopic echo` and `ros2 topic echo` print of a CameraInfo: one message.
/// @throws std::invalid_argument by YamlFields::fail
CameraIntrinsics read_printed_camera(const YamlFields& file, bool is_rectified);

}  // namespace clearway
