#pragma once

#include <filesystem>
#include <memory>
#include <string>
#include <vector>

#include "datasets/sources/frame_source.hpp"

namespace clearway {

/// A file of poses of a folder's clouds, as loop closure programs write them (SC-PGO): poses.txt in it, or
/// optimized_poses.txt or poses.txt above a folder that is called Scans. Empty: there is none.
std::filesystem::path scan_poses_beside(const std::filesystem::path& folder);

/// .pcd and .ply files as scans of kind "points", in the order and at the times in their names. Rays begin
/// at the files' viewpoints, and points are in the map's frame or in the sensor's, as the options say. Where
/// no file of several has a viewpoint, the setup does not say in whose frame points are, and does not place
/// the sensor, `poses` do: a line of 12 numbers for each, in the order of names, the pose of the sensor, in
/// whose frame the points are then.
/// @param poses a file, or empty @param name of the recording and of the sensor
/// @throws std::invalid_argument when poses that are used are not for these clouds
std::unique_ptr<FrameSource> open_clouds(const std::vector<std::filesystem::path>& files,
                                         const std::filesystem::path& poses, const std::string& name,
                                         const SourceOptions& options);

}  // namespace clearway
