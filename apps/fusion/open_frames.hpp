#pragma once

#include <filesystem>
#include <memory>

#include "datasets/sources/frame_source.hpp"

namespace clearway {

/// What a recording may be, for sentences that refuse something else.
inline constexpr const char* kinds_of_recordings =
    "an MRPT rawlog, a ROS bag (.bag, .mcap), a .pcd, .ply, .png or .jpg file, or a folder of such files";

/// Whatever holds frames, told by what it is:
/// - a folder of .png and .jpg files, or one of them: images (datasets/pictures/image_folder.hpp);
/// - a folder of .pcd and .ply files, or one of them: scans of kind "points", each seen from the file's
///   viewpoint, which is in the same frame as its points. Their time is the number that is their name (as the
///   TUM benchmark names them), else 0, 1, 2, ... s;
/// - a .bag or .mcap file: topics that the setup names (datasets/ros/bag_source.hpp);
/// - else an MRPT rawlog.
/// Sensors are called like the folder, or the single file.
/// @throws std::invalid_argument in one sentence when it is none of these.
std::unique_ptr<FrameSource> open_frames(const std::filesystem::path& recording,
                                         const SourceOptions& options);

}  // namespace clearway
