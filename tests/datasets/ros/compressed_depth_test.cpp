#include "datasets/ros/compressed_depth.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <cstring>
#include <random>

#include "datasets/bags/bag_source.hpp"
#include "datasets/bags/mcap_writer.hpp"
#include "datasets/ros/sensor_frames.hpp"
#include "datasets/ros/wire_writer.hpp"
#include "tests/datasets/complaint.hpp"
#include "tests/worlds/bytes/picture_bytes.hpp"
#include "tests/worlds/temporary_folder.hpp"

namespace clearway {
namespace compressed_depth_test {

using Bytes = std::vector<std::uint8_t>;

template <class Number>
void append(Bytes& bytes, Number value) {
  const auto* const first = reinterpret_cast<const std::uint8_t*>(&value);
  bytes.insert(bytes.end(), first, first + sizeof value);
}

/// The message's parameters: the compression, and a and b of depth = a / (step - b).
Bytes parameters(float a = 0.0F, float b = 0.0F) {
  Bytes bytes;
  append(bytes, std::int32_t{0});
  append(bytes, a);
  append(bytes, b);
  return bytes;
}

Bytes with_png(Bytes bytes, const cv::Mat& steps) {
  const std::string png = picture_bytes(steps, ".png");
  bytes.insert(bytes.end(), png.begin(), png.end());
  return bytes;
}

/// RVL as Wilson 2017 writes it down (his figure 2), over words of eight nibbles.
class RvlWriter {
 public:
  explicit RvlWriter(const cv::Mat_<std::uint16_t>& depth) {
    append(bytes_, static_cast<std::int32_t>(depth.cols));
    append(bytes_, static_cast<std::int32_t>(depth.rows));
    const std::uint16_t *at = depth[0], *const end = at + depth.total();
    int previous = 0;
    while (at != end) {
      const std::uint16_t* const zeros = at;
      while (at != end && *at == 0) ++at;
      number(static_cast<int>(at - zeros));
      const std::uint16_t* const rest = at;
      while (at != end && *at != 0) ++at;
      number(static_cast<int>(at - rest));
      for (const std::uint16_t* pixel = rest; pixel != at; ++pixel) {
        const int delta = *pixel - previous;
        number((delta << 1) ^ (delta >> 31));
        previous = *pixel;
      }
    }
    while (nibbles_ > 0) nibble(0);
  }
  const Bytes& bytes() const { return bytes_; }

 private:
  void number(int value) {
    do {
      const int low = value & 7;
      value >>= 3;
      nibble(static_cast<std::uint32_t>(value != 0 ? low | 8 : low));
    } while (value != 0);
  }
  void nibble(std::uint32_t value) {
    word_ = word_ << 4U | value;
    if (++nibbles_ < 8) return;
    append(bytes_, word_);
    nibbles_ = 0;
  }
  Bytes bytes_;
  std::uint32_t word_ = 0;
  int nibbles_ = 0;
};

Bytes with_rvl(Bytes bytes, const cv::Mat_<std::uint16_t>& steps) {
  const RvlWriter rvl(steps);
  bytes.insert(bytes.end(), rvl.bytes().begin(), rvl.bytes().end());
  return bytes;
}

cv::Mat_<std::uint16_t> random_depth(unsigned seed) {
  std::mt19937 random(seed);
  cv::Mat_<std::uint16_t> depth(5 + static_cast<int>(seed % 7), 11);
  for (std::uint16_t& pixel : depth)
    pixel = random() % 3 == 0 ? 0 : static_cast<std::uint16_t>(random() % (seed % 2 == 0 ? 65536 : 40));
  return depth;
}

UnpackedDepth unpack(const std::string& format, const Bytes& bytes) {
  return unpack_depth({{12.5, "lens"}, format, bytes});
}

void expect_the_same(const RosImage& image, const cv::Mat_<std::uint16_t>& depth) {
  EXPECT_EQ(image.encoding, "16UC1");
  EXPECT_EQ(image.header.frame, "lens");
  ASSERT_EQ(image.width, static_cast<std::uint32_t>(depth.cols));
  ASSERT_EQ(image.height, static_cast<std::uint32_t>(depth.rows));
  ASSERT_EQ(image.data.size(), 2 * depth.total());
  EXPECT_EQ(std::memcmp(image.data.data(), depth.data, image.data.size()), 0);
}

TEST(CompressedDepth, OfWholeStepsIsLossless) {
  for (unsigned seed = 0; seed < 200; ++seed) {
    const auto depth = random_depth(seed);
    expect_the_same(unpack("16UC1; compressedDepth png", with_png(parameters(), depth)).image, depth);
    expect_the_same(unpack("16UC1; compressedDepth", with_png(parameters(), depth)).image, depth);
    expect_the_same(unpack("16UC1; compressedDepth rvl", with_rvl(parameters(), depth)).image, depth);
    expect_the_same(unpack("16UC1; png compressed ", with_png({}, depth)).image, depth);
  }
}

TEST(CompressedDepth, OfMetresKeepsThemWithinItsSteps) {
  // As the transport packs it: a = z0 (z0 + 1), b = 1 - a / most, step = a / depth + b.
  constexpr float z0 = 100.0F, most = 10.0F, a = z0 * (z0 + 1.0F), b = 1.0F - a / most;
  cv::Mat_<std::uint16_t> steps(4, 6, std::uint16_t{0});
  std::vector<float> metres;
  for (int i = 0; i < 24; ++i) {
    metres.push_back(0.4F + 0.4F * static_cast<float>(i));
    if (i != 7) steps(i / 6, i % 6) = static_cast<std::uint16_t>(a / metres.back() + b);
  }
  for (const UnpackedDepth& depth :
       {unpack("32FC1; compressedDepth png", with_png(parameters(a, b), steps)),
        unpack("32FC1; compressedDepth rvl", with_rvl(parameters(a, b), steps))}) {
    EXPECT_EQ(depth.image.encoding, "32FC1");
    ASSERT_EQ(depth.image.data.size(), 4U * 24U);
    for (std::size_t i = 0; i < 24; ++i) {
      float value = 0;
      std::memcpy(&value, &depth.image.data[4 * i], 4);
      if (i == 7)
        EXPECT_TRUE(std::isnan(value));
      else
        EXPECT_NEAR(value, metres[i], 1.01F * metres[i] * metres[i] / a) << i;  // a step of inverse depth
    }
  }
}

TEST(CompressedDepth, ThatContradictsItselfIsRefused) {
  const auto depth = random_depth(2);
  const Bytes rvl = with_rvl(parameters(), depth);
  const auto clause = [](const std::string& format, const Bytes& bytes) {
    try {
      unpack(format, bytes);
    } catch (const std::runtime_error& error) {
      return std::string(error.what());
    }
    return std::string("none");
  };
  EXPECT_EQ(clause("jpeg", {}), "its format 'jpeg' is no depth, expected compressedDepth, or 16UC1 as PNG");
  EXPECT_EQ(clause("16UC1; compressedDepth", {1, 2}), "it is cut off");
  EXPECT_EQ(clause("16UC1; compressedDepth", parameters()), "it cannot be decoded");
  EXPECT_EQ(clause("16UC1; compressedDepth", with_png(parameters(), cv::Mat(3, 3, CV_8UC1, cv::Scalar(9)))),
            "it is not a grey picture of 16 bits");
  EXPECT_EQ(clause("32FC1; compressedDepth", with_png(parameters(), depth)),
            "its parameters of depth are no numbers");
  EXPECT_EQ(clause("16UC1; compressedDepth rvl", Bytes(rvl.begin(), rvl.end() - 4)), "its RVL is cut off");
  Bytes huge = rvl, more = rvl;
  huge[15] = 1;
  EXPECT_EQ(clause("16UC1; compressedDepth rvl", huge), "its RVL has no size of an image");
  more[12] = 1;  // a picture one pixel wide with the content of eleven
  EXPECT_EQ(clause("16UC1; compressedDepth rvl", more), "its RVL has more pixels than it says");
  EXPECT_EQ(clause("16UC1; compressedDepth rvl", Bytes(rvl.begin(), rvl.begin() + 15)), "it is cut off");
  std::mt19937 random(3);
  for (int i = 0; i < 2000; ++i) {  // nothing but a clause or an image
    Bytes damaged = rvl;
    for (int k = 0; k < 3; ++k)
      damaged[20 + random() % (damaged.size() - 20)] = static_cast<std::uint8_t>(random());
    clause("16UC1; compressedDepth rvl", damaged);
  }
}

TEST(CompressedDepth, OfABagBecomesScansThroughTheCameraOfTheSetup) {
  const TemporaryFolder folder;
  const cv::Mat_<std::uint16_t> depth(36, 48, std::uint16_t{2000});
  McapWriter bag(folder / "b.mcap");
  const std::uint16_t topic = bag.add_topic("/depth", "sensor_msgs/msg/CompressedImage", "uint8[] data\n");
  WireWriter message;
  message.number(std::int32_t{50});
  message.number(std::uint32_t{0});
  message.text("lens");
  message.text("16UC1; compressedDepth png");
  message.bytes(with_png(parameters(), depth));
  bag.write(topic, 50.0, message.message());
  bag.finish();
  SourceOptions options;
  options.bag.depth = {{"/depth", ""}};
  EXPECT_NE(
      complaint([&] { open_bag(folder / "b.mcap", options); }).find("needs the camera of topic '/depth'"),
      std::string::npos);
  options.camera = CameraIntrinsics{48, 36, 50, 52, 24, 18, {}};
  const auto source = open_bag(folder / "b.mcap", options);
  const auto frame = source->next();
  ASSERT_TRUE(frame) << source->damage().value_or("");
  const auto& cloud = std::get<CloudFrame>(frame->content);
  ASSERT_EQ(cloud.points.size(), 48U * 36U);
  EXPECT_TRUE(cloud.points[10 * 48 + 34].isApprox(Eigen::Vector3f(2, -2 * 10.F / 50, 2 * 8.F / 52), 1e-5F));
}

}  // namespace compressed_depth_test
}  // namespace clearway
