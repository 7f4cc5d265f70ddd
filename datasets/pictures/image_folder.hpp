#pragma once

#include <filesystem>
#include <memory>
#include <vector>

#include "datasets/sources/frame_source.hpp"

namespace clearway {

/// PNG and JPEG pictures as the images of one camera, in the order of their times (picture_times.hpp). The
/// camera is the setup's: a picture gives none. A picture that cannot be decoded is reported and left out;
/// the others are kept.
/// @param files of one folder, at least one
/// @param sensor what the frames' sensor is called
/// @throws std::invalid_argument as times_of_files does
std::unique_ptr<FrameSource> open_pictures(const std::vector<std::filesystem::path>& files,
                                           const std::string& sensor, const SourceOptions& options);

}  // namespace clearway
