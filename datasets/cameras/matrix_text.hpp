#pragma once

#include <optional>
#include <string>

#include "datasets/cameras/image_size.hpp"
#include "datasets/sources/recording.hpp"

namespace clearway {

/// Whether a text holds numbers alone, apart by blanks or commas, but for what follows `#`; not an empty one.
bool is_numbers_alone(const std::string& text);

/// A camera without distortion, of a text with its matrix, 3 by 3 or 4 by 4, row by row (ScanNet's
/// intrinsic_depth.txt, camera-intrinsics.txt beside 7-Scenes' pictures), or fx fy cx cy in one row (ETH3D's
/// calibration.txt). @param name what errors call the
/// file @param size of its pictures, which such a file does not say
/// @throws std::invalid_argument in one sentence: another matrix, or no size
CameraIntrinsics camera_of_matrix_text(const std::string& text, const std::string& name,
                                       std::optional<ImageSize> size);

}  // namespace clearway
