#include "tracking/annotated_image.hpp"

#include <algorithm>
#include <cmath>
#include <opencv2/imgcodecs.hpp>
#include <opencv2/imgproc.hpp>

namespace clearway {
namespace {

constexpr int shift = 4;            ///< OpenCV's lines take sixteenths of a pixel
constexpr double farthest = 30000;  ///< pixels; beyond, its fixed point would overflow

cv::Point fixed(const Eigen::Vector2d& pixel) {
  return {static_cast<int>(std::lround(pixel.x() * (1 << shift))),
          static_cast<int>(std::lround(pixel.y() * (1 << shift)))};
}

bool is_drawable(const Eigen::Vector2d& pixel) {
  return pixel.allFinite() && pixel.cwiseAbs().maxCoeff() < farthest;
}

}  // namespace

std::string annotated_png(const cv::Mat& gray, const std::vector<ImageMark>& marks) {
  cv::Mat picture;
  cv::cvtColor(gray, picture, cv::COLOR_GRAY2BGR);
  const int thickness = std::max(1, std::min(gray.cols, gray.rows) / 400);
  for (const ImageMark& mark : marks) {
    const cv::Scalar colour(mark.colour[2], mark.colour[1], mark.colour[0]);
    const std::size_t count = mark.line.size();
    for (std::size_t i = 0; i + (mark.is_closed ? 0 : 1) < count; ++i) {
      const Eigen::Vector2d &from = mark.line[i], &to = mark.line[(i + 1) % count];
      if (is_drawable(from) && is_drawable(to))
        cv::line(picture, fixed(from), fixed(to), colour, thickness, cv::LINE_AA, shift);
    }
    if (mark.label.empty() || count == 0 || !is_drawable(mark.line[0])) continue;
    const cv::Point at(static_cast<int>(mark.line[0].x()) + 2, static_cast<int>(mark.line[0].y()) - 4);
    cv::putText(picture, mark.label, at, cv::FONT_HERSHEY_SIMPLEX, 0.4 * thickness, colour, thickness,
                cv::LINE_AA);
  }
  std::vector<unsigned char> bytes;
  cv::imencode(".png", picture, bytes);
  return {bytes.begin(), bytes.end()};
}

}  // namespace clearway
