#include "datasets/pictures/depth_picture.hpp"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstring>
#include <opencv2/imgcodecs.hpp>
#include <set>
#include <sstream>
#include <stdexcept>
#include <variant>

#include "datasets/depth_files/exr_file.hpp"
#include "datasets/depth_files/npy_file.hpp"
#include "datasets/depth_files/tiff_numbers.hpp"
#include "datasets/pictures/files_in_child.hpp"
#include "datasets/pictures/picture_file.hpp"
#include "mapping/system/input_file.hpp"

namespace clearway {
namespace {

/// Bit by bit, as NaN is no number to compare.
bool is_same(const cv::Mat& a, const cv::Mat& b) {
  const std::size_t bytes = a.elemSize() * static_cast<std::size_t>(a.cols);
  for (int row = 0; row < a.rows; ++row)
    if (std::memcmp(a.ptr(row), b.ptr(row), bytes) != 0) return false;
  return true;
}

/// All channels of a picture that hold the same are one: who writes depth as a picture of colours repeats it.
cv::Mat only_channel(const cv::Mat& picture) {
  std::vector<cv::Mat> channels;
  cv::split(picture, channels);
  for (std::size_t i = 1; i < channels.size(); ++i)
    if (i < 3 && !is_same(channels[0], channels[i]))
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
  if (!(head >> magic >> width >> height >> sign) || sign == 0.0)
    throw std::runtime_error("its head cannot be read");
  if (head.peek() == '\r') head.get();
  if (head.get() == EOF) throw std::runtime_error("it is cut off");
  const ImageSize size = require_picture_size(width, height);
  const auto at = static_cast<std::size_t>(head.tellg());
  const auto pixels = static_cast<std::size_t>(width * height);
  if (bytes.size() - at != pixels * sizeof(float))
    throw std::runtime_error("it has " + std::to_string(bytes.size() - at) + " bytes of numbers, expected " +
                             std::to_string(pixels * sizeof(float)));
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

/// The real numbers whose four bytes each pixel of a picture of colours and alpha is, as TartanAir V2 packs
/// them into PNG; empty: some are none that a sensor sees, as of every picture that is opaque.
cv::Mat unpacked(const cv::Mat& pixels) {
  constexpr float least = 1e-6F, most = 1e7F;  // m
  const cv::Mat numbers(pixels.rows, pixels.cols, CV_32F, const_cast<uchar*>(pixels.data), pixels.step);
  bool has_depth = false;
  for (const float value : cv::Mat_<float>(numbers)) {
    if (value == 0.0F || value == INFINITY) continue;  // none there
    if (!(value >= least && value <= most)) return {};
    has_depth = true;
  }
  return has_depth ? numbers.clone() : cv::Mat();
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
  if (depth.type() == CV_8UC4)
    if (const cv::Mat numbers = unpacked(depth); !numbers.empty()) depth = numbers;
  const bool is_real = depth.depth() == CV_32F || depth.depth() == CV_64F;
  if (is_real) depth = only_channel(depth);
  if (!is_real && depth.type() != CV_16UC1 && depth.type() != CV_32SC1)
    throw std::runtime_error("it is not a grey picture of 16 bits, of 32 bits or of real numbers");
  DepthPicture picture{{depth.cols, depth.rows}, {}, is_real};
  cv::Mat_<float> values;
  depth.convertTo(values, CV_32F);
  picture.values.assign(values.begin(), values.end());
  return picture;
}

/// Whether a PNG has colours and alpha of 8 bits, the bytes of unpacked().
bool may_be_packed(const std::filesystem::path& file) {
  constexpr std::size_t bits_at = 24, kind_at = 25;
  std::string head;
  InputFile(file, "picture").read_at(0, kind_at + 1, head);
  return head.size() > kind_at && head.starts_with("\x89PNG") && head[bits_at] == 8 && head[kind_at] == 6;
}

/// Of depths that are all negative, unless they are a few numbers that stand for "none".
void require_some_before(const DepthPicture& picture) {
  constexpr std::size_t most_codes = 4;
  std::set<float> depths;
  for (const float value : picture.values) {
    if (value > 0.0F) return;
    if (std::isfinite(value) && value < 0.0F && depths.size() <= most_codes) depths.insert(value);
  }
  if (depths.size() > most_codes)
    throw std::runtime_error(
        "all its depths are negative, as along the -z of OpenGL: expected positive ones");
}

}  // namespace

bool is_depth_array(const std::filesystem::path& file) {
  const auto all = {".npy", ".pfm", ".exr"};
  return std::find(all.begin(), all.end(), extension_of(file)) != all.end();
}

bool is_depth_alone(const std::filesystem::path& file) {
  return extension_of(file) == ".pgm" || is_depth_array(file);
}

DepthPicture decode_depth_picture(const std::string& bytes) {
  DepthPicture picture = is_npy(bytes)             ? decode_npy(bytes)
                         : is_exr(bytes)           ? decode_exr(bytes)
                         : bytes.starts_with("Pf") ? decode_pfm(bytes)
                                                   : decode_by_opencv(with_signed_numbers(bytes));
  require_some_before(picture);
  for (float& value : picture.values)
    if (!(std::isfinite(value) && value > 0.0F) || value == saturated_depth) value = 0.0F;
  return picture;
}

std::optional<DepthPictureHead> depth_picture_head(const std::vector<std::filesystem::path>& files) {
  constexpr std::size_t most = 20;
  for (std::size_t i = 0; i < std::min(files.size(), most); ++i) {
    if (const auto size = picture_size(files[i]); size && !may_be_packed(files[i]))
      return DepthPictureHead{*size, false};
    FilesInChild picture({files[i]}, "depth picture", [](const std::string& bytes, std::size_t) {
      const DepthPicture decoded = decode_depth_picture(bytes);
      CloudFrame head;
      head.points.emplace_back(decoded.size.width, decoded.size.height, decoded.is_real ? 1.0F : 0.0F);
      return head;
    });
    const auto outcome = picture.next();
    if (!outcome || !outcome->content) continue;  // told when it is read
    const Eigen::Vector3f& head = std::get<CloudFrame>(*outcome->content).points.front();
    return DepthPictureHead{{static_cast<int>(head.x()), static_cast<int>(head.y())}, head.z() != 0.0F};
  }
  return std::nullopt;
}

}  // namespace clearway
