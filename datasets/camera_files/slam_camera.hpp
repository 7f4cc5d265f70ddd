#pragma once

#include <optional>
#include <string>

#include "datasets/cameras/image_size.hpp"
#include "datasets/sources/recording.hpp"
#include "datasets/yaml/yaml_fields.hpp"

namespace clearway {

/// camodocal's, which VINS takes: a pinhole with a plumb bob, or Kannala and Brandt's, whose coefficients
/// count from k2 (camodocal, EquidistantCamera.cc). @throws std::invalid_argument by YamlFields::fail
CameraIntrinsics read_camodocal(const YamlFields& file, std::optional<ImageSize> given, bool is_rectified);

/// Whether it is settings of an ORB-SLAM.
bool is_orb_slam(const YamlFields& file);

/// ORB-SLAM's settings, of the camera that is wanted; else of the one or the left one.
/// @throws std::invalid_argument by YamlFields::fail
CameraIntrinsics read_orb_slam(const YamlFields& fields, const std::string& wanted,
                               std::optional<ImageSize> given, bool is_rectified);

}  // namespace clearway
