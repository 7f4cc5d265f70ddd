#pragma once

#include <filesystem>
#include <memory>
#include <optional>

#include "datasets/sources/frame_source.hpp"

namespace clearway {

/// Where a folder keeps its depth pictures, colour pictures and poses.
struct DepthLayout {
  std::vector<std::filesystem::path> depth, colour;  ///< colour may be empty
  std::filesystem::path poses;                       ///< TUM text or numbered poses; empty: none
  std::filesystem::path pose_folder;                 ///< of a matrix for each depth picture; empty: none
  std::filesystem::path camera;                      ///< a file of the depth pictures' camera; empty: none
};

/// The layout of a folder as RGB-D data sets are published: `depth/` beside `rgb/`, `color/` or `image/`
/// (TUM, ICL-NUIM, ScanNet, Redwood), or in it or its folder `results/` pictures whose names begin or end in
/// "depth" beside others of "color", "rgb", "image" or "frame" (7-Scenes, Replica); with `groundtruth.txt`,
/// `poses.txt`, `trajectory.txt`, `trajectory.log`, `traj.txt` or the one file `.log` or `.freiburg`, or a
/// folder `pose/` or `poses/`, or NAME.pose.txt; and `intrinsic/intrinsic_depth.txt` (ScanNet),
/// `camera_intrinsic.json` (Open3D) or another file that is called like a camera's. None when it holds no
/// depth pictures.
/// @throws std::filesystem::filesystem_error when one of the folders cannot be read
std::optional<DepthLayout> depth_layout(const std::filesystem::path& folder);

/// Depth pictures (16-bit PNG: the distance along the optical axis, 0 and 65535: none) as scans of kind and
/// sensor "depth", cast through the lens of their camera (depth_rays), colour pictures as images of sensor
/// "colour", in the order of their times. Scans for which no pose is known are left out and counted, unless
/// the setup places the sensor. Their camera is that of `depth` in the options, else that of the options:
/// who calls reads `layout.camera` into them.
/// @throws std::invalid_argument when the camera or the poses are not given, or they cannot be read, or the
/// camera of rectified pictures has a distortion
std::unique_ptr<FrameSource> open_depth_folder(const std::filesystem::path& folder, const DepthLayout& layout,
                                               const SourceOptions& options);

}  // namespace clearway
