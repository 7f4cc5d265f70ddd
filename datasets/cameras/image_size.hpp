#pragma once

#include <cstdint>

namespace clearway {

constexpr int longest_side = 20000;  ///< of a picture, pixels

/// Of a camera's pictures, in pixels.
struct ImageSize {
  int width = 0, height = 0;
  bool operator==(const ImageSize&) const = default;
};

/// @throws std::runtime_error a clause for sides that are not 1 to 20,000, or more than 64 million pixels
ImageSize require_picture_size(std::int64_t width, std::int64_t height);

}  // namespace clearway
