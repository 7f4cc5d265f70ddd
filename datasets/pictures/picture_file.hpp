#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>

#include "datasets/cameras/image_size.hpp"
#include "datasets/sources/recording.hpp"

namespace clearway {

/// True for a name that ends in .png, .jpg, .jpeg, .bmp, .tif, .tiff, .webp or .ppm, in small or capital
/// letters.
bool is_picture_file(const std::filesystem::path& file);

/// A picture of one of these formats, or PGM, as grey, its pixels as they are stored (an orientation in EXIF
/// does not turn them: a calibration belongs to the sensor). OpenCV's decoders may crash on hostile files, so
/// this is called in a child process alone. @throws std::runtime_error a clause that says why there is no
/// picture: not one, cut off, sides beyond 20,000 or 64 million pixels.
GrayImage decode_picture(const std::string& bytes);

/// What the head of a PNG, JPEG or binary PGM file says; nothing for another file, or one that cannot be
/// read.
std::optional<ImageSize> picture_size(const std::filesystem::path& file);

/// False for a JPEG without an end of its pixels, which OpenCV would fill up with grey; true for all else.
bool is_whole(const std::string& bytes);

/// EXIF's DateTimeOriginal with its SubSecTime as seconds since 1970 (its time zone is not known: UTC is
/// taken); below 0 without one. To be called in a child process, too. @param bytes the file, or its beginning
double exif_time(const std::string& bytes);

}  // namespace clearway
