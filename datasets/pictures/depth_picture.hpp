#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "datasets/cameras/image_size.hpp"
#include "datasets/depth_files/depth_values.hpp"

namespace clearway {

/// What is known of a depth picture before all of them are read.
struct DepthPictureHead {
  ImageSize size;
  bool is_real = false;
};

/// True for a name that ends in .npy, .pfm or .exr.
bool is_depth_array(const std::filesystem::path& file);

/// True for a name that ends in .pgm (3RScan's), .npy, .pfm or .exr: depth, where a folder holds depth.
bool is_depth_alone(const std::filesystem::path& file);

/// What cameras write in 16 bits where there is no return, or one too far to be counted.
constexpr std::uint16_t saturated_depth = 65535;

/// The depth in a grey picture of 16 bits (PNG, PGM, TIFF) or 32 bits (TIFF), one of real numbers (TIFF,
/// OpenEXR, PFM, or whose bytes are the colours and alpha of a PNG as TartanAir V2 packs them) or a NumPy
/// array (.npy: two axes, or a third of one entry; whole numbers or real ones of up to 64 bits). What is not
/// finite, or below 0, or saturated_depth, is none. Pictures' decoders may crash on hostile files, so this is
/// called in a child process alone. @throws std::runtime_error a clause that says why there is none
DepthPicture decode_depth_picture(const std::string& bytes);

/// Of the first of these files, of twenty at most, that can be read: of a PNG or binary PGM by its first
/// bytes, of others by decoding it in a child process; nothing where there is none.
std::optional<DepthPictureHead> depth_picture_head(const std::vector<std::filesystem::path>& files);

}  // namespace clearway
