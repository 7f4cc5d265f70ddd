#include "datasets/cameras/packed_pixels.hpp"

#include <gtest/gtest.h>

#include <utility>
#include <vector>

#include "tests/datasets/complaint.hpp"

namespace clearway {
namespace packed_pixels_test {

using Bytes = std::vector<std::uint8_t>;

Bytes bytes_of(const std::vector<std::uint16_t>& numbers, bool is_bigendian) {
  Bytes bytes;
  for (const std::uint16_t number : numbers) {
    const auto low = static_cast<std::uint8_t>(number), high = static_cast<std::uint8_t>(number >> 8U);
    bytes.push_back(is_bigendian ? high : low);
    bytes.push_back(is_bigendian ? low : high);
  }
  return bytes;
}

PackedPixels packed(const std::string& encoding, std::size_t width, std::size_t height, const Bytes& data) {
  return {encoding, width, height, data.size() / height, false, data};
}

/// Cameras of 10 and 12 bits fill the lowest ones; of all 16 the upper byte is the picture.
TEST(PackedPixels, OfSixteenBitsAreTheUpperOnesThatAreInUse) {
  for (const auto& [numbers, expected] : std::vector<std::pair<std::vector<std::uint16_t>, Bytes>>{
           {{0, 512, 1023}, {0, 128, 255}},
           {{0, 2048, 4095}, {0, 128, 255}},
           {{0x1234, 0x8000, 0xffff}, {0x12, 0x80, 0xff}},
           {{0, 7, 200}, {0, 7, 200}},
           {{0, 0, 0}, {0, 0, 0}}}) {
    for (const char* encoding : {"mono16", "16UC1"}) {
      for (const bool is_bigendian : {false, true}) {
        const Bytes data = bytes_of(numbers, is_bigendian);
        PackedPixels pixels = packed(encoding, 3, 1, data);
        pixels.is_bigendian = is_bigendian;
        EXPECT_EQ(gray_pixels(pixels).pixels, expected) << encoding << ' ' << numbers[2];
      }
    }
  }
}

TEST(PackedPixels, OfSixteenBitsHaveColoursAndBayerPatternsAsThoseOfEight) {
  const Bytes small = {9, 40, 200, 7, 250, 251, 252, 60, 250, 240, 233, 76, 255, 254, 253, 255};
  std::vector<std::uint16_t> numbers;
  for (const std::uint8_t number : small) numbers.push_back(static_cast<std::uint16_t>(257 * number));
  const Bytes wide = bytes_of(numbers, false);
  for (const auto& [encoding, width, height] :
       std::vector<std::tuple<std::string, std::size_t, std::size_t>>{{"bayer_rggb", 4, 4},
                                                                      {"bayer_bggr", 4, 4},
                                                                      {"bayer_gbrg", 4, 4},
                                                                      {"bayer_grbg", 4, 4},
                                                                      {"rgba", 2, 2},
                                                                      {"bgra", 2, 2}}) {
    const GrayImage eight = gray_pixels(packed(encoding + "8", width, height, small));
    const GrayImage sixteen = gray_pixels(packed(encoding + "16", width, height, wide));
    ASSERT_EQ(sixteen.pixels.size(), eight.pixels.size());
    for (std::size_t i = 0; i < eight.pixels.size(); ++i)
      EXPECT_NEAR(sixteen.pixels[i], eight.pixels[i], 1) << encoding << ' ' << i;
  }
  const Bytes colours = bytes_of({0xffff, 0, 0, 0xffff, 0xffff, 0xffff}, false);  // in OpenCV's weights
  EXPECT_EQ(gray_pixels(packed("rgb16", 2, 1, colours)).pixels, (Bytes{76, 255}));
  EXPECT_EQ(gray_pixels(packed("bgr16", 2, 1, colours)).pixels, (Bytes{29, 255}));
}

/// All of the brightness, then the colours, whatever length of a row the driver states.
TEST(PackedPixels, OfPlanesAreTheFirstOne) {
  const Bytes data = {1, 2, 3, 4, 5, 6, 7, 8, 128, 128, 128, 128};
  for (const char* encoding : {"nv12", "nv21"}) {
    for (const std::size_t step : {4, 8, 0}) {
      PackedPixels pixels = packed(encoding, 4, 2, data);
      pixels.step = step;
      EXPECT_EQ(gray_pixels(pixels).pixels, (Bytes{1, 2, 3, 4, 5, 6, 7, 8})) << encoding << ' ' << step;
    }
  }
  const Bytes padded = {1, 2, 0, 0, 3, 4, 0, 0, 128, 128, 0, 0};
  PackedPixels pixels = packed("nv21", 2, 2, padded);
  pixels.step = 4;
  EXPECT_EQ(gray_pixels(pixels).pixels, (Bytes{1, 2, 3, 4}));
}

TEST(PackedPixels, RefuseWhatIsCutOffOrOfNoKnownEncoding) {
  const Bytes data = {1, 2, 3, 4, 5, 6, 7, 8};
  const auto sentence = [&](const std::string& encoding, std::size_t width) {
    PackedPixels pixels = packed(encoding, width, 2, data);
    pixels.step = std::max<std::size_t>(4, width);
    return complaint<std::runtime_error>([&] { gray_pixels(pixels); });
  };
  EXPECT_EQ(sentence("mono16", 2), "");
  EXPECT_EQ(sentence("mono16", 3), "its data is shorter than its size says");
  EXPECT_EQ(sentence("nv12", 5), "its data is shorter than its size says");
  EXPECT_EQ(sentence("mono12", 2), "its encoding 'mono12' is not known here");
  EXPECT_NE(sentence("mono8", 20'001), "");
}

}  // namespace packed_pixels_test
}  // namespace clearway
