#pragma once

#include <filesystem>
#include <memory>

#include "datasets/sources/frame_source.hpp"

namespace clearway {

/// True for a file that begins as MP4, MOV, Matroska, WebM, AVI, MPEG or Ogg. Nothing else is given to the
/// video library: a playlist could name other files.
bool is_video_file(const std::filesystem::path& file);

/// The pictures of a video (OpenCV's videoio, in a DecodingChild) as the images of one camera, which is the
/// setup's. Times are the video's own, from 0 s, or counted by the setup's rate.
/// @throws std::invalid_argument when it cannot be read
std::unique_ptr<FrameSource> open_video(const std::filesystem::path& file, const SourceOptions& options);

}  // namespace clearway
