#pragma once

#include <filesystem>
#include <memory>

#include "datasets/descriptions/setup.hpp"
#include "datasets/sources/frame_source.hpp"

namespace clearway {

/// What a recording may be, for sentences that refuse something else.
inline constexpr const char* kinds_of_recordings =
    "an MRPT rawlog, a ROS bag (.bag, .mcap, .db3), a scan graph of OctoMap (.graph), ScanNet's .sens, a "
    "video, a .pcd, .ply, "
    ".bin, .png or .jpg file, or a folder of such files or of depth pictures";

/// Whatever holds frames, recognized by what it is:
/// - a folder of depth pictures as RGB-D data sets have it (datasets/pictures/depth_folder.hpp);
/// - a video, recognized by its first bytes (datasets/pictures/video.hpp);
/// - a folder of .png and .jpg files (else of .bmp, .tif, .webp, .ppm or .pgm, where no clouds are), or one
///   of them: images (datasets/pictures/image_folder.hpp);
/// - a folder of .pcd and .ply files, or one of them: scans of kind "points", each seen from the file's
///   viewpoint, which is in the same frame as its points. Their time is the number that is their name (as the
///   TUM benchmark names them), else 0, 1, 2, ... s;
/// - a folder of .bin files, or one of them: scans of kind "velodyne" (apps/fusion/velodyne_folder.hpp),
/// where
///   there is nothing of the above;
/// - a .bag, .mcap or .db3 file, or the folder that `ros2 bag record` makes: topics that the setup names
/// (datasets/bags/bag_source.hpp);
/// - a scan graph of OctoMap (datasets/sources/scan_graph.hpp);
/// - ScanNet's .sens (datasets/bags/sens_file.hpp);
/// - else an MRPT rawlog.
/// Sensors are called like the folder, or the single file.
/// @throws std::invalid_argument in one sentence when it is none of these.
std::unique_ptr<FrameSource> open_frames(const std::filesystem::path& recording,
                                         const SourceOptions& options);

/// A setup and where it comes from: a file, "embedded in the recording" or "none".
struct ChosenSetup {
  Setup setup;
  std::string source = "none";
};

/// The setup of that file; without one, that which `clearway simulate` embeds in a recording (its first
/// comment); else an empty one. @throws std::invalid_argument as load_setup and open_frames do.
ChosenSetup choose_setup(const std::filesystem::path& recording, const std::filesystem::path& setup_file);

}  // namespace clearway
