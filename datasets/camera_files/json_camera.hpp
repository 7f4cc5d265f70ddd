#pragma once

#include <optional>
#include <string>

#include "datasets/cameras/image_size.hpp"
#include "datasets/sources/recording.hpp"
#include "datasets/yaml/yaml_fields.hpp"

namespace clearway {

/// Whether a map is a camera by the names `fx`, `fy`, `cx`, `cy`.
bool is_plain_camera(const YamlFields& fields);

/// The map of a file that is a camera of librealsense, of Open3D or of plain numbers: itself, or one in it,
/// by the name of that or of what holds it. Nothing when there is none.
/// @throws std::invalid_argument by YamlFields::fail where there are several and none is `wanted`
std::optional<YamlFields> json_camera(const YamlFields& file, const std::string& wanted);

/// A camera of these kinds. @throws std::invalid_argument by YamlFields::fail
CameraIntrinsics read_json_camera(const YamlFields& fields, std::optional<ImageSize> given,
                                  bool is_rectified);

}  // namespace clearway
