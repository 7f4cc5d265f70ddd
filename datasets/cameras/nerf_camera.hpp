#pragma once

#include <optional>
#include <string>

#include "datasets/cameras/image_size.hpp"
#include "datasets/cameras/path_fields.hpp"
#include "datasets/sources/recording.hpp"

namespace clearway {

/// As far as they are known; of a folder without colour pictures both are those of its depth pictures.
struct PictureSizes {
  std::optional<ImageSize> depth, colour;
};

/// nerfstudio's camera of a frame of its transforms.json: what it says itself comes before what the file
/// says. The middle of the first pixel is at 0.5 there, at 0 here. Nothing: it states none, or not its size.
/// @throws std::invalid_argument in one sentence naming the file, the place and what was expected
std::optional<CameraIntrinsics> nerf_camera(const PathFields& file, const PathFields& frame,
                                            const std::optional<PictureSizes>& sizes);

/// Whether a text is JSON with what only nerfstudio and instant-ngp write.
bool is_nerf_file(const std::string& text);

/// The camera that all pictures of a transforms.json have. @param name what errors call the file
/// @param size of its pictures, where it is known from elsewhere: the file may leave it out
/// @throws std::invalid_argument also where they have several, or none is stated
CameraIntrinsics camera_of_nerf_file(const std::string& text, const std::string& name,
                                     const std::optional<ImageSize>& size);

}  // namespace clearway
