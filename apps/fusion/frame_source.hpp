#pragma once

#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "datasets/sources/recording.hpp"

namespace clearway {

/// Frames in the order they were taken, from whatever holds them.
class FrameSource {
 public:
  virtual ~FrameSource() = default;
  virtual std::optional<Frame> next() = 0;
  virtual std::optional<std::string> damage() const = 0;  ///< what ended the reading early
  virtual std::vector<std::string> warnings() const = 0;
  virtual double progress() const = 0;  ///< 0 to 1
};

/// A rawlog; or a .pcd or .ply file, or a folder of them in the order of their names, as scans of kind
/// "points": each seen from the file's viewpoint, which is in the same frame as its points. Their time is the
/// number that is their name (as the TUM benchmark names them), else 0, 1, 2, ... s; their sensor is called
/// like the folder, or the single file.
/// @throws std::invalid_argument in one sentence when it is none of these.
std::unique_ptr<FrameSource> open_frames(const std::filesystem::path& recording);

}  // namespace clearway
