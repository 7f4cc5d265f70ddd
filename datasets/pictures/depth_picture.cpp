#include "datasets/pictures/depth_picture.hpp"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstring>
#include <opencv2/imgcodecs.hpp>
#include <sstream>
#include <stdexcept>
#include <variant>

#include "datasets/pictures/exr_file.hpp"
#include "datasets/pictures/files_in_child.hpp"
#include "datasets/pictures/npy_file.hpp"
#include "datasets/pictures/picture_file.hpp"
#include "mapping/system/input_file.hpp"

namespace clearway {
namespace {

constexpr float no_depth = 65535.0F;

/// All channels of a picture that hold the same are one: who writes depth as a picture of colours repeats it.
cv::Mat only_channel(const cv::Mat& picture) {
  std::vector<cv::Mat> channels;
  cv::split(picture, channels);
  for (std::size_t i = 1; i < channels.size(); ++i)
    if (i < 3 && cv::norm(channels[0], channels[i], cv::NORM_INF) != 0.0)
      throw std::runtime_error("it holds colours: expected one number of depth in each pixel");
  return channels.front();
}

/// Rows of floats after three lines of text, the lowest first; the third line's sign tells the order of
/// bytes. Its absolute value, a unit that no reader of depth applies, is not heard.
DepthPicture decode_pfm(const std::string& bytes) {
  std::istringstream head(bytes.substr(0, 200));
  head.imbue(std::locale::classic());
  std::string magic;
  std::int64_t width = 0, height = 0;
  double sign = 0.0;
  if (!(head >> magic >> width >> height >> sign) || sign == 0.0 || head.get() == EOF)
    throw std::runtime_error("its head cannot be read");
  const ImageSize size = require_picture_size(width, height);
  const auto at = static_cast<std::size_t>(head.tellg());
  const auto pixels = static_cast<std::size_t>(width * height);
  if (bytes.size() - at < pixels * sizeof(float)) throw std::runtime_error("it is cut off");
  DepthPicture picture{size, std::vector<float>(pixels), true};
  const bool is_swapped = (sign > 0.0) == (std::endian::native == std::endian::little);
  for (std::size_t i = 0; i < pixels; ++i) {
    std::array<char, sizeof(float)> own;
    std::memcpy(own.data(), &bytes[at + i * own.size()], own.size());
    if (is_swapped) std::reverse(own.begin(), own.end());
    const auto columns = static_cast<std::size_t>(width),
               row = static_cast<std::size_t>(height) - 1 - i / columns;
    std::memcpy(&picture.values[row * columns + i % columns], own.data(), own.size());
  }
  return picture;
}

DepthPicture decode_by_opencv(const std::string& bytes) {
  const cv::Mat_<unsigned char> raw(1, static_cast<int>(bytes.size()),
                                    reinterpret_cast<unsigned char*>(const_cast<char*>(bytes.data())));
  cv::Mat depth;
  try {
    depth = cv::imdecode(raw, cv::IMREAD_UNCHANGED);
  } catch (const cv::Exception&) {
  }
  if (depth.empty()) throw std::runtime_error("it cannot be decoded");
  const bool is_real = depth.depth() == CV_32F || depth.depth() == CV_64F;
  if (is_real) depth = only_channel(depth);
  if (!is_real && depth.type() != CV_16UC1)
    throw std::runtime_error("it is not a grey picture of 16 bits or of real numbers");
  DepthPicture picture{{depth.cols, depth.rows}, {}, is_real};
  cv::Mat_<float> values;
  depth.convertTo(values, CV_32F);
  picture.values.assign(values.begin(), values.end());
  if (!is_real) std::replace(picture.values.begin(), picture.values.end(), no_depth, 0.0F);
  return picture;
}

}  // namespace

bool is_depth_alone(const std::filesystem::path& file) {
  const auto all = {".pgm", ".npy", ".pfm", ".exr"};
  return std::find(all.begin(), all.end(), extension_of(file)) != all.end();
}

DepthPicture decode_depth_picture(const std::string& bytes) {
  DepthPicture picture = is_npy(bytes)             ? decode_npy(bytes)
                         : is_exr(bytes)           ? decode_exr(bytes)
                         : bytes.starts_with("Pf") ? decode_pfm(bytes)
                                                   : decode_by_opencv(bytes);
  for (float& value : picture.values)
    if (!(std::isfinite(value) && value > 0.0F)) value = 0.0F;
  return picture;
}

std::optional<DepthPictureHead> depth_picture_head(const std::filesystem::path& file) {
  if (const auto size = picture_size(file)) return DepthPictureHead{*size, false};
  FilesInChild one({file}, "depth picture", [](const std::string& bytes, std::size_t) {
    const DepthPicture picture = decode_depth_picture(bytes);
    CloudFrame head;
    head.points.emplace_back(picture.size.width, picture.size.height, picture.is_real ? 1.0F : 0.0F);
    return head;
  });
  const auto outcome = one.next();
  if (!outcome || !outcome->content) return std::nullopt;
  const Eigen::Vector3f& head = std::get<CloudFrame>(*outcome->content).points.front();
  return DepthPictureHead{{static_cast<int>(head.x()), static_cast<int>(head.y())}, head.z() != 0.0F};
}

}  // namespace clearway
