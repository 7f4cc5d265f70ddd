#include "datasets/cameras/packed_pixels.hpp"

#include <algorithm>
#include <bit>
#include <map>
#include <opencv2/imgproc.hpp>
#include <stdexcept>

#include "datasets/cameras/image_size.hpp"
#include "mapping/system/plain_text.hpp"

namespace clearway {
namespace {

/// How OpenCV sees an encoding: the pixel type, and how to make it grey (-1: it is).
struct Encoding {
  int type, to_gray;
};

const std::map<std::string, Encoding>& encodings() {
  static const std::map<std::string, Encoding> known{
      {"mono8", {CV_8UC1, -1}},
      {"8UC1", {CV_8UC1, -1}},
      {"rgb8", {CV_8UC3, cv::COLOR_RGB2GRAY}},
      {"bgr8", {CV_8UC3, cv::COLOR_BGR2GRAY}},
      {"8UC3", {CV_8UC3, cv::COLOR_BGR2GRAY}},
      {"rgba8", {CV_8UC4, cv::COLOR_RGBA2GRAY}},
      {"bgra8", {CV_8UC4, cv::COLOR_BGRA2GRAY}},
      {"8UC4", {CV_8UC4, cv::COLOR_BGRA2GRAY}},
      {"yuv422", {CV_8UC2, cv::COLOR_YUV2GRAY_UYVY}},
      {"uyvy", {CV_8UC2, cv::COLOR_YUV2GRAY_UYVY}},
      {"yuv422_yuy2", {CV_8UC2, cv::COLOR_YUV2GRAY_YUY2}},
      {"yuyv", {CV_8UC2, cv::COLOR_YUV2GRAY_YUY2}},
      {"YUYV", {CV_8UC2, cv::COLOR_YUV2GRAY_YUY2}},  // librealsense
      {"nv12", {CV_8UC1, -1}},                       // all of the brightness comes first
      {"nv21", {CV_8UC1, -1}},
      {"nv24", {CV_8UC1, -1}},
      {"bayer_rggb8", {CV_8UC1, cv::COLOR_BayerBG2GRAY}},
      {"bayer_bggr8", {CV_8UC1, cv::COLOR_BayerRG2GRAY}},
      {"bayer_gbrg8", {CV_8UC1, cv::COLOR_BayerGR2GRAY}},
      {"bayer_grbg8", {CV_8UC1, cv::COLOR_BayerGB2GRAY}},
      {"mono16", {CV_16UC1, -1}},
      {"16UC1", {CV_16UC1, -1}},
      {"rgb16", {CV_16UC3, cv::COLOR_RGB2GRAY}},
      {"bgr16", {CV_16UC3, cv::COLOR_BGR2GRAY}},
      {"16UC3", {CV_16UC3, cv::COLOR_BGR2GRAY}},
      {"rgba16", {CV_16UC4, cv::COLOR_RGBA2GRAY}},
      {"bgra16", {CV_16UC4, cv::COLOR_BGRA2GRAY}},
      {"16UC4", {CV_16UC4, cv::COLOR_BGRA2GRAY}},
      {"bayer_rggb16", {CV_16UC1, cv::COLOR_BayerBG2GRAY}},
      {"bayer_bggr16", {CV_16UC1, cv::COLOR_BayerRG2GRAY}},
      {"bayer_gbrg16", {CV_16UC1, cv::COLOR_BayerGR2GRAY}},
      {"bayer_grbg16", {CV_16UC1, cv::COLOR_BayerGB2GRAY}}};
  return known;
}

/// Some drivers say of nv12 the bytes of a row of another plane, or none: where the data are just as many as
/// the image has, a row of the first one is as long as the image is wide.
std::size_t step_of(const PackedPixels& pixels) {
  const std::size_t area = pixels.width * pixels.height;
  const std::size_t planes = pixels.encoding == "nv24" ? 3 * area : area + area / 2;
  return pixels.encoding.starts_with("nv") && pixels.data.size() == planes ? pixels.width : pixels.step;
}

/// In memory of its own, where numbers lie as this machine has them.
cv::Mat unpacked(const PackedPixels& pixels, int type) {
  cv::Mat image(static_cast<int>(pixels.height), static_cast<int>(pixels.width), type);
  const std::size_t bytes = pixels.width * CV_ELEM_SIZE(type);
  for (int row = 0; row < image.rows; ++row) {
    std::uint8_t* const to = image.ptr(row);
    std::copy_n(&pixels.data[static_cast<std::size_t>(row) * pixels.step], bytes, to);
    if (CV_MAT_DEPTH(type) == CV_16U && pixels.is_bigendian)
      for (std::size_t i = 0; i + 1 < bytes; i += 2) std::swap(to[i], to[i + 1]);
  }
  return image;
}

}  // namespace

void require_rows(const PackedPixels& pixels, std::size_t pixel_bytes) {
  if (pixels.width == 0 || pixels.height == 0 || pixels.width > longest_side || pixels.height > longest_side)
    throw std::runtime_error("its sides are " + std::to_string(pixels.width) + " x " +
                             std::to_string(pixels.height) + ", expected 1 to 20000 pixels each");
  if (pixels.step < pixels.width * pixel_bytes || pixels.data.size() / pixels.step < pixels.height)
    throw std::runtime_error("its data is shorter than its size says");
}

GrayImage gray_pixels(const PackedPixels& pixels) {
  const auto encoding = encodings().find(pixels.encoding);
  if (encoding == encodings().end())
    throw std::runtime_error("its encoding " + quote(pixels.encoding) + " is not known here");
  PackedPixels rows = pixels;
  rows.step = step_of(pixels);
  require_rows(rows, CV_ELEM_SIZE(encoding->second.type));
  const cv::Mat image = unpacked(rows, encoding->second.type);
  cv::Mat gray;
  try {
    if (encoding->second.to_gray < 0)
      gray = image;
    else
      cv::cvtColor(image, gray, encoding->second.to_gray);
  } catch (const cv::Exception&) {
    throw std::runtime_error("its size does not fit its encoding " + quote(pixels.encoding));
  }
  if (gray.depth() == CV_16U)
    return narrowed(gray.cols, gray.rows, {gray.ptr<std::uint16_t>(), gray.total()});
  return {gray.cols, gray.rows, {gray.data, gray.data + gray.total()}};
}

GrayImage narrowed(int width, int height, std::span<const std::uint16_t> pixels) {
  const std::uint16_t brightest =
      pixels.empty() ? std::uint16_t{0} : *std::max_element(pixels.begin(), pixels.end());
  const int unused = std::max(std::bit_width(brightest) - 8, 0);
  GrayImage image{width, height, {}};
  image.pixels.reserve(pixels.size());
  for (const std::uint16_t pixel : pixels) image.pixels.push_back(static_cast<std::uint8_t>(pixel >> unused));
  return image;
}

}  // namespace clearway
