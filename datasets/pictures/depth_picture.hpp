#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "datasets/cameras/image_size.hpp"

namespace clearway {

/// A picture of depth, as its file holds it.
struct DepthPicture {
  ImageSize size;
  std::vector<float> values;  ///< row by row; 0: none
  bool is_real = false;  ///< real numbers, of metres if nothing else is stated; else whole ones, of steps
};

/// What calls for no decoding, or for that of one picture.
struct DepthPictureHead {
  ImageSize size;
  bool is_real = false;
};

/// True for a name that ends in .pgm (3RScan's), .npy, .pfm or .exr: depth, where a folder holds depth.
bool is_depth_alone(const std::filesystem::path& file);

/// The depth in a grey picture of 16 bits (PNG, PGM, TIFF; 65535 is none, too), one of real numbers (TIFF,
/// OpenEXR, PFM) or a NumPy array (.npy: two axes, or a third of one entry; whole numbers or real ones of up
/// to 64 bits). What is not finite, or below 0, is none. Pictures' decoders may crash on hostile files, so
/// this is called in a child process alone. @throws std::runtime_error a clause that says why there is none
DepthPicture decode_depth_picture(const std::string& bytes);

/// Of a PNG or binary PGM file from its first bytes, of others by decoding it in a child process; nothing for
/// one that cannot be read.
std::optional<DepthPictureHead> depth_picture_head(const std::filesystem::path& file);

}  // namespace clearway
