#pragma once

#include <string>
#include <vector>

#include "datasets/sources/recording.hpp"

namespace clearway {

class YamlFields;
struct CapsuleSetup;

/// {width, height, fx, fy, cx, cy, distortion: [k1, k2, p1, p2, k3]} of a setup or scene; the map must hold
/// nothing else. @throws std::invalid_argument
CameraIntrinsics read_camera(const YamlFields& fields);

/// A list of {from, to, radius} under `key`; empty when absent. @throws std::invalid_argument
std::vector<CapsuleSetup> read_capsules(const YamlFields& fields, const std::string& key);

}  // namespace clearway
