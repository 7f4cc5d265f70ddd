#pragma once

#include <optional>
#include <string>
#include <vector>

#include "datasets/camera_files/coefficients_beside.hpp"

namespace clearway {

/// A camera of librealsense, of Open3D or of plain numbers in a file.
struct JsonCamera {
  YamlFields fields;
  std::vector<CameraHolder> holders;  ///< from the file inwards; none: the file is the camera
};

/// The one of a file: itself, or one in it, by the name of that or of what holds it. Nothing when there is
/// none. @throws std::invalid_argument by YamlFields::fail where there are several and none is `wanted`
std::optional<JsonCamera> json_camera(const YamlFields& file, const std::string& wanted);

/// A camera of these kinds. Its coefficients may stand beside it, as `rgbDistortion` beside `rgbIntrinsic`,
/// and the name of its lens in what holds it. @throws std::invalid_argument by YamlFields::fail, also where
/// it is not sure to which camera coefficients belong
CameraIntrinsics read_json_camera(const JsonCamera& camera, BesideFile& beside);

}  // namespace clearway
