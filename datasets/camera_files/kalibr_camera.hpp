#pragma once

#include <string>

#include "datasets/sources/recording.hpp"
#include "datasets/yaml/yaml_fields.hpp"

namespace clearway {

/// One camera of kalibr's camchain, or EuRoC's sensor.yaml. @throws std::invalid_argument by YamlFields::fail
CameraIntrinsics read_chain_camera(const YamlFields& fields, bool is_rectified);

/// Whether a key of a file is a camera of kalibr's camchain.
bool is_of_camchain(const YamlFields& file, const std::string& key);

/// @param wanted the camera of several; may be empty when there is one
/// @throws std::invalid_argument by YamlFields::fail
CameraIntrinsics read_camchain(const YamlFields& file, const std::string& wanted, bool is_rectified);

}  // namespace clearway
