#pragma once

#include <filesystem>
#include <memory>

#include "datasets/sources/frame_source.hpp"

namespace clearway {

/// True for a file that begins as MP4, MOV, Matroska, WebM, AVI, MPEG, MPEG-TS or Ogg. Nothing else is given
/// to the video library: a playlist could name other files.
bool is_video_file(const std::filesystem::path& file);

/// The pictures of a video (OpenCV's videoio, in a DecodingChild) as the images of one camera, which is the
/// setup's. Times are the video's own, from 0 s, or counted by the setup's rate.
/// @throws std::invalid_argument when it cannot be read
std::unique_ptr<FrameSource> open_video(const std::filesystem::path& file, const SourceOptions& options);

/// True for names as Linux gives them to cameras: /dev/video0. Inline: who asks need not link the video
/// library.
inline bool is_camera_name(const std::filesystem::path& path) {
  return path.parent_path() == "/dev" && path.filename().string().starts_with("video");
}

/// What a camera shows for `options.camera_seconds` (OpenCV's videoio, in a DecodingChild). Times are those
/// of the wall clock, seconds since 1970. While next() is not called pictures are dropped, not kept.
/// @throws std::invalid_argument when there is no such camera
std::unique_ptr<FrameSource> open_camera(const std::filesystem::path& device, const SourceOptions& options);

}  // namespace clearway
