#pragma once

#include "datasets/sources/recording.hpp"

namespace clearway {

class YamlFields;

/// {width, height, fx, fy, cx, cy, distortion: [k1, k2, p1, p2, k3]} of a setup or scene; the map must hold
/// nothing else. @throws std::invalid_argument
CameraIntrinsics read_camera(const YamlFields& fields);

}  // namespace clearway
