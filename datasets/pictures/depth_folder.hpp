#pragma once

#include <filesystem>
#include <memory>

#include "datasets/pictures/depth_layout.hpp"
#include "datasets/sources/frame_source.hpp"

namespace clearway {

/// Depth pictures (decode_depth_picture: the distance along the optical axis) as scans of kind and
/// sensor "depth", cast through the lens of their camera (depth_rays), colour pictures as images of sensor
/// "colour", in the order of their times. Scans for which no pose is known are left out and counted, unless
/// the setup places the sensor. Their camera is that of `depth` in the options, else that of the options:
/// who calls reads `layout.camera` into them; else that of the poses' file, for each picture its own.
/// @throws std::invalid_argument when the camera or the poses are not given, or they cannot be read, or the
/// camera of rectified pictures has a distortion
std::unique_ptr<FrameSource> open_depth_folder(const std::filesystem::path& folder, const DepthLayout& layout,
                                               const SourceOptions& options);

}  // namespace clearway
