#pragma once

#include <Eigen/Core>
#include <array>
#include <cstdint>
#include <opencv2/core/mat.hpp>
#include <string>
#include <vector>

namespace clearway {

/// A line to draw into an image, with a word at its beginning.
struct ImageMark {
  std::vector<Eigen::Vector2d> line;  ///< pixels, the upper left one's centre at (0, 0); may leave the image
  bool is_closed = false;
  std::array<std::uint8_t, 3> colour{};  ///< red, green, blue
  std::string label;                     ///< may be empty
};

/// The image with the marks in it, as the bytes of a PNG file. @param gray CV_8UC1, not empty
std::string annotated_png(const cv::Mat& gray, const std::vector<ImageMark>& marks);

}  // namespace clearway
