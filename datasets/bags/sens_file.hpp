#pragma once

#include <filesystem>
#include <memory>

#include "datasets/sources/frame_source.hpp"

namespace clearway {

/// True for a file called .sens.
bool is_sens_file(const std::filesystem::path& file);

/// ScanNet's recording in one file: depth as scans of kind and sensor "depth", cast through the file's or the
/// setup's camera, at the file's poses, or where the setup places the sensor, and colours as images of sensor
/// "colour". It is decoded in a DecodingChild; frames without a pose are left out and counted, and so are
/// damaged ones.
/// @throws std::invalid_argument when it cannot be read, or the setup names other poses
std::unique_ptr<FrameSource> open_sens(const std::filesystem::path& file, const SourceOptions& options);

}  // namespace clearway
