#include "datasets/cameras/image_size.hpp"

#include <algorithm>
#include <stdexcept>
#include <string>

namespace clearway {
namespace {

constexpr std::int64_t most_pixels = 64'000'000;

}  // namespace

ImageSize require_picture_size(std::int64_t width, std::int64_t height) {
  if (std::min(width, height) < 1 || std::max(width, height) > longest_side || width * height > most_pixels)
    throw std::runtime_error("it has " + std::to_string(width) + " x " + std::to_string(height) +
                             " pixels, expected sides of at most 20,000 and 64 million pixels");
  return {static_cast<int>(width), static_cast<int>(height)};
}

}  // namespace clearway
