#pragma once

#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "datasets/sources/frame_source.hpp"

namespace clearway {

/// Where a folder keeps scans as KITTI has them (mapping/files/velodyne_scan.hpp); all but the scans may be
/// empty.
struct VelodyneLayout {
  std::vector<std::filesystem::path> scans;
  std::filesystem::path poses;  ///< poses.txt: 12 numbers a line, or TUM text
  std::filesystem::path
      calibration;  ///< calib.txt, whose `Tr` is camera_from_scanner; also `Tr_velo_to_cam`, `Tr_velo_cam`,
                    ///< and of raw data calib_velo_to_cam.txt
  std::filesystem::path times;  ///< times.txt, seconds, one a line
};

/// .bin files in the folder, or in its `velodyne/`; the others beside them or, of a folder that is called
/// velodyne, above it; poses also in ../../poses/NAME.txt of a folder NAME in `sequences/`, as KITTI's
/// odometry has them. None when there is no scan.
/// @throws std::filesystem::filesystem_error when the folder cannot be read
std::optional<VelodyneLayout> velodyne_layout(const std::filesystem::path& folder);

/// Scans of kind "velodyne" in the order of their names, at the times of times.txt, else of their names.
/// Their places are those of poses.txt, a line for each, or of many lines those of the numbers that are their
/// names. With a `Tr`, these are a camera's, and the scanner is at world_from_camera * camera_from_scanner,
/// as KITTI defines it. One scan without poses is in the map's frame.
/// @param name of the recording and of the sensor
/// @throws std::invalid_argument when several scans have no poses and the setup does not place them, or a
/// file beside them cannot be read or is not for these scans
std::unique_ptr<FrameSource> open_velodyne(const VelodyneLayout& layout, const std::string& name,
                                           const SourceOptions& options);

}  // namespace clearway
