#pragma once

#include <string>

#include "datasets/depth_files/depth_values.hpp"

namespace clearway {

/// Whether these are the bytes of an OpenEXR picture.
bool is_exr(const std::string& bytes);

/// The depth in an OpenEXR picture: its channel Z, depth.Z, … or V (Blender's layers); else its only one;
/// else R, where G and B hold the same. @throws std::runtime_error a clause that says why there is none
DepthPicture decode_exr(const std::string& bytes);

}  // namespace clearway
