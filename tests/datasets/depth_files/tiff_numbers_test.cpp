#include "datasets/depth_files/tiff_numbers.hpp"

#include <gtest/gtest.h>

#include <cstdint>
#include <vector>

#include "datasets/pictures/depth_picture.hpp"
#include "tests/worlds/bytes/picture_bytes.hpp"

namespace clearway {
namespace tiff_numbers_test {

/// A TIFF of one strip by hand, as libtiff and tifffile write them; without `format` it has no SampleFormat.
std::string tiff(bool is_big, unsigned bits, unsigned format, const std::vector<std::uint32_t>& pixels,
                 unsigned width) {
  const auto number = [is_big](unsigned value, std::size_t count) {
    std::string bytes(count, '\0');
    for (std::size_t i = 0; i < count; ++i)
      bytes[is_big ? count - 1 - i : i] = static_cast<char>(value >> 8U * i & 0xffU);
    return bytes;
  };
  std::string data;
  for (const std::uint32_t pixel : pixels) data += number(pixel, bits / 8);
  const auto rows = static_cast<unsigned>(pixels.size()) / width;
  std::vector<std::pair<unsigned, unsigned>> entries{
      {256, width}, {257, rows}, {258, bits},
      {259, 1},     {262, 1},    {273, 8},
      {277, 1},     {278, rows}, {279, static_cast<unsigned>(data.size())}};
  if (format != 0) entries.emplace_back(339, format);
  std::string bytes =
      (is_big ? "MM" : "II") + number(42, 2) + number(8 + static_cast<unsigned>(data.size()), 4);
  bytes += data + number(static_cast<unsigned>(entries.size()), 2);
  for (const auto& [tag, value] : entries)
    bytes += number(tag, 2) + number(3, 2) + number(1, 4) + number(value, 2) + number(0, 2);
  return bytes + number(0, 4);
}

const std::vector<std::uint32_t> steps{0, 1500, 70000, 4000000000, 5, 6};

TEST(TiffNumbers, OfThirtyTwoBitsWithoutASignAreSteps) {
  for (const bool is_big : {false, true})
    for (const unsigned format : {0U, 1U, 2U}) {
      const DepthPicture picture = decode_depth_picture(tiff(is_big, 32, format, steps, 3));
      EXPECT_EQ(picture.size, (ImageSize{3, 2}));
      EXPECT_FALSE(picture.is_real);
      EXPECT_EQ(picture.values, (std::vector<float>{0, 1500, 70000, 0, 5, 6})) << is_big << format;
    }
}

TEST(TiffNumbers, OtherBytesStayAsTheyAre) {
  const std::string real = tiff(false, 32, 3, {0x3fc00000, 0x40000000}, 2);
  EXPECT_EQ(with_signed_numbers(real), real);
  EXPECT_EQ(decode_depth_picture(real).values, (std::vector<float>{1.5F, 2.0F}));
  const std::string narrow = tiff(false, 16, 1, steps, 3);
  EXPECT_EQ(with_signed_numbers(narrow), narrow);
  const std::string whole = tiff(false, 32, 0, steps, 3);
  for (std::size_t size = 0; size < whole.size() - 4; ++size)
    EXPECT_EQ(with_signed_numbers(whole.substr(0, size)), whole.substr(0, size)) << size;
  const std::string png = picture_bytes(cv::Mat(3, 3, CV_16UC1, cv::Scalar(9)), ".png");
  EXPECT_EQ(with_signed_numbers(png), png);
}

}  // namespace tiff_numbers_test
}  // namespace clearway
