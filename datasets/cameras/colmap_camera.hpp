#pragma once

#include <string>

#include "datasets/sources/recording.hpp"

namespace clearway {

/// Whether a text is COLMAP's cameras.txt: lines `CAMERA_ID MODEL WIDTH HEIGHT PARAMS…` whose models are in
/// capitals, apart from comments; or the bytes of its cameras.bin.
bool is_colmap_cameras(const std::string& text);

/// A camera of it. COLMAP counts pixels from the corner of the first one, and so its principal point is half
/// a pixel larger than ours (colmap.github.io, "Camera Models"). Known are SIMPLE_PINHOLE, PINHOLE,
/// SIMPLE_RADIAL, RADIAL, OPENCV, OPENCV_FISHEYE, FULL_OPENCV, SIMPLE_RADIAL_FISHEYE, RADIAL_FISHEYE,
/// SIMPLE_FISHEYE and FISHEYE.
/// @param wanted its CAMERA_ID; empty: the only one @param name what errors call the file
/// @throws std::invalid_argument in one sentence naming file, line or camera, and what was expected
CameraIntrinsics camera_of_colmap(const std::string& text, const std::string& name,
                                  const std::string& wanted);

}  // namespace clearway
