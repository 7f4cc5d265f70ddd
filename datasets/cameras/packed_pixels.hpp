#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <string>

#include "datasets/sources/recording.hpp"

namespace clearway {

/// An image as a camera's driver packs it: `encoding` as ROS names it (sensor_msgs/image_encodings).
struct PackedPixels {
  std::string encoding;
  std::size_t width = 0, height = 0;
  std::size_t step = 0;       ///< bytes of a row
  bool is_bigendian = false;  ///< of numbers of two bytes
  std::span<const std::uint8_t> data;
};

/// @throws std::runtime_error a clause: sides beyond 20,000 pixels, or data shorter than the size says
void require_rows(const PackedPixels& pixels, std::size_t pixel_bytes);

/// As grey: mono, 8UC1 to 8UC4, rgb, bgr, rgba, bgra and bayer_* of 8 and of 16 bits, 16UC1 to 16UC4, yuv422
/// (UYVY), yuv422_yuy2, nv12, nv21 and nv24. @throws std::runtime_error a clause, as require_rows, or for
/// another encoding
GrayImage gray_pixels(const PackedPixels& pixels);

/// Pixels of 16 bits as 8, the upper ones of those that are in use: cameras of 10 or 12 bits fill the lowest.
/// @pre pixels.size() == width * height
GrayImage narrowed(int width, int height, std::span<const std::uint16_t> pixels);

}  // namespace clearway
