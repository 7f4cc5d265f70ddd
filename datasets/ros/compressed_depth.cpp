#include "datasets/ros/compressed_depth.hpp"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <limits>
#include <opencv2/imgcodecs.hpp>
#include <stdexcept>
#include <string>
#include <utility>

#include "datasets/cameras/image_size.hpp"
#include "mapping/system/plain_text.hpp"

namespace clearway {
namespace {

constexpr std::size_t parameter_bytes = 12, rvl_header_bytes = 8;
constexpr std::size_t most_pixels = 64'000'000;

using Bytes = std::span<const std::uint8_t>;

/// Little-endian, as the machines that record bags are.
template <class Number>
Number number_at(Bytes bytes, std::size_t at) {
  Number value;
  std::memcpy(&value, bytes.subspan(at, sizeof value).data(), sizeof value);
  return value;
}

struct Steps {
  std::uint32_t width = 0, height = 0;
  std::vector<std::uint16_t> of_pixel;
};

/// Three bits at a time, the highest of each four says whether more follow.
class RvlNumbers {
 public:
  explicit RvlNumbers(Bytes bytes) : bytes_(bytes) {}
  std::uint32_t next() {
    std::uint32_t value = 0, nibble = 0;
    int shift = 0;
    do {
      if (left_ == 0) read_word();
      nibble = word_ >> 28U;
      word_ <<= 4U;
      --left_;
      if (shift > 30) throw std::runtime_error("its RVL holds a number too large");
      value |= (nibble & 7U) << static_cast<unsigned>(shift);
      shift += 3;
    } while ((nibble & 8U) != 0);
    return value;
  }

 private:
  void read_word() {
    if (bytes_.size() - at_ < 4) throw std::runtime_error("its RVL is cut off");
    word_ = number_at<std::uint32_t>(bytes_, at_);
    at_ += 4;
    left_ = 8;
  }
  Bytes bytes_;
  std::size_t at_ = 0;
  std::uint32_t word_ = 0;
  int left_ = 0;
};

Steps unpack_rvl(Bytes bytes) {
  if (bytes.size() < rvl_header_bytes) throw std::runtime_error("it is cut off");
  Steps steps{number_at<std::uint32_t>(bytes, 0), number_at<std::uint32_t>(bytes, 4), {}};
  const std::size_t count = std::size_t{steps.width} * steps.height;
  if (count == 0 || steps.width > std::uint32_t{longest_side} || steps.height > std::uint32_t{longest_side} ||
      count > most_pixels)
    throw std::runtime_error("its RVL has no size of an image");
  RvlNumbers numbers(bytes.subspan(rvl_header_bytes));
  steps.of_pixel.reserve(count);
  const auto run = [&] {
    const std::uint32_t length = numbers.next();
    if (length > count - steps.of_pixel.size())
      throw std::runtime_error("its RVL has more pixels than it says");
    return length;
  };
  std::uint32_t last = 0;
  while (steps.of_pixel.size() < count) {
    steps.of_pixel.resize(steps.of_pixel.size() + run(), 0);
    for (std::uint32_t left = run(); left > 0; --left) {
      const std::uint32_t change = numbers.next();
      last += (change >> 1U) ^ (0U - (change & 1U));
      steps.of_pixel.push_back(static_cast<std::uint16_t>(last));
    }
  }
  return steps;
}

Steps unpack_png(Bytes bytes) {
  cv::Mat picture;
  try {
    const cv::Mat_<unsigned char> raw(1, static_cast<int>(bytes.size()),
                                      const_cast<std::uint8_t*>(bytes.data()));
    picture = cv::imdecode(raw, cv::IMREAD_UNCHANGED);
  } catch (const cv::Exception&) {
  }
  if (picture.empty()) throw std::runtime_error("it cannot be decoded");
  if (picture.type() != CV_16UC1) throw std::runtime_error("it is not a grey picture of 16 bits");
  Steps steps{static_cast<std::uint32_t>(picture.cols), static_cast<std::uint32_t>(picture.rows), {}};
  for (int row = 0; row < picture.rows; ++row)
    steps.of_pixel.insert(steps.of_pixel.end(), picture.ptr<std::uint16_t>(row),
                          picture.ptr<std::uint16_t>(row) + picture.cols);
  return steps;
}

/// Of compressed_depth_image_transport: depth = a / (step - b).
std::vector<float> metres_of(const Steps& steps, Bytes parameters) {
  const float a = number_at<float>(parameters, 4), b = number_at<float>(parameters, 8);
  if (!std::isfinite(a) || !std::isfinite(b) || a <= 0.0F)
    throw std::runtime_error("its parameters of depth are no numbers");
  std::vector<float> metres;
  metres.reserve(steps.of_pixel.size());
  for (const std::uint16_t step : steps.of_pixel)
    metres.push_back(step == 0 ? std::numeric_limits<float>::quiet_NaN()
                               : a / (static_cast<float>(step) - b));
  return metres;
}

UnpackedDepth unpacked(const RosHeader& header, const Steps& steps, const char* encoding, const void* pixels,
                       std::size_t pixel_bytes) {
  UnpackedDepth depth;
  const auto* const first = static_cast<const std::uint8_t*>(pixels);
  depth.bytes.assign(first, first + steps.of_pixel.size() * pixel_bytes);
  depth.image.header = header;
  depth.image.height = steps.height;
  depth.image.width = steps.width;
  depth.image.step = steps.width * static_cast<std::uint32_t>(pixel_bytes);
  depth.image.encoding = encoding;
  depth.image.data = depth.bytes;
  return depth;
}

bool holds(const std::string& text, const char* word) { return text.find(word) != std::string::npos; }

}  // namespace

UnpackedDepth unpack_depth(const RosCompressedImage& packed) {
  const bool is_transport = holds(packed.format, "compressedDepth"),
             is_float = packed.format.starts_with("32FC1");
  if (!is_transport && !(packed.format.starts_with("16UC1") || packed.format.starts_with("mono16")))
    throw std::runtime_error("its format " + quote(packed.format) +
                             " is no depth, expected compressedDepth, or 16UC1 as PNG");
  if (is_transport && packed.data.size() < parameter_bytes) throw std::runtime_error("it is cut off");
  const Bytes inside = packed.data.subspan(is_transport ? parameter_bytes : 0);
  const Steps steps = is_transport && holds(packed.format, "rvl") ? unpack_rvl(inside) : unpack_png(inside);
  if (!is_transport || !is_float)
    return unpacked(packed.header, steps, "16UC1", steps.of_pixel.data(), sizeof(std::uint16_t));
  const std::vector<float> metres = metres_of(steps, packed.data.first(parameter_bytes));
  return unpacked(packed.header, steps, "32FC1", metres.data(), sizeof(float));
}

}  // namespace clearway
