#pragma once

namespace clearway {

/// Of a camera's pictures, in pixels.
struct ImageSize {
  int width = 0, height = 0;
  bool operator==(const ImageSize&) const = default;
};

}  // namespace clearway
