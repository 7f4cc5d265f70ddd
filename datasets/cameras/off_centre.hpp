#pragma once

#include <string>

#include "datasets/sources/recording.hpp"

namespace clearway {

/// Whether the principal point is farther from the middle of the pictures than a tenth of their width or
/// height, as where numbers belong to pictures of another size, or these are a part of larger ones.
bool is_off_centre(const CameraIntrinsics& camera);

/// "has its principal point at (319.5, 239.5), far from the middle of pictures of 320 x 240 pixels, …".
std::string off_centre_clause(const CameraIntrinsics& camera);

}  // namespace clearway
