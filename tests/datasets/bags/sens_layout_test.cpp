#include "datasets/bags/sens_layout.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "tests/datasets/complaint.hpp"
#include "tests/worlds/bytes/sens_bytes.hpp"

namespace clearway {
namespace sens_layout_test {

SensLayout read(const std::string& bytes) {
  return read_sens_layout(bytes.size(), [&](std::uint64_t at, std::size_t count) {
    return at < bytes.size() ? bytes.substr(at, count) : std::string();
  });
}

const std::vector<SensPictures> two{{{1, 0, 0, 4, 0, 1, 0, 5, 0, 0, 1, 6, 0, 0, 0, 1}, 7, "jpeg", {1, 2, 3}},
                                    {{-INFINITY}, 8, "", {4}}};

TEST(SensLayout, SaysWhereThePicturesAreAndWhatTheyAre) {
  const std::string bytes = sens_bytes(two, 0);
  const SensLayout layout = read(bytes);
  EXPECT_EQ(layout.depth, (CameraIntrinsics{48, 36, 50, 52, 24, 18, {}}));
  EXPECT_EQ(layout.colour, (CameraIntrinsics{96, 72, 100, 104, 48, 36, {}}));
  EXPECT_NEAR(layout.step, 0.001, 1e-12);
  EXPECT_TRUE(layout.has_pictures);
  EXPECT_FALSE(layout.is_depth_packed || layout.is_depth_moved);
  ASSERT_EQ(layout.frames.size(), 2U);
  EXPECT_EQ(layout.damage, "");
  EXPECT_EQ(layout.frames[0].world_from_camera.value().translation(), Eigen::Vector3d(4, 5, 6));
  EXPECT_EQ(layout.frames[0].depth_time, 7U);
  EXPECT_EQ(bytes.substr(layout.frames[0].colour.at, layout.frames[0].colour.size), "jpeg");
  EXPECT_EQ(bytes.substr(layout.frames[0].depth.at, layout.frames[0].depth.size),
            std::string("\1\0\2\0\3\0", 6));
  EXPECT_FALSE(layout.frames[1].world_from_camera);
  EXPECT_EQ(bytes.substr(layout.frames[1].depth.at, layout.frames[1].depth.size), std::string("\4\0", 2));
}

TEST(SensLayout, WhatIsCutOffEndsThereOrIsRefused) {
  const std::string bytes = sens_bytes(two, 0);
  const std::uint64_t first = read(bytes).frames[0].colour.at - 96, end = bytes.size() - 8;
  for (std::size_t size = 0; size < end; ++size) {
    const std::string cut = bytes.substr(0, size);
    if (size < first) {
      EXPECT_EQ(complaint<std::runtime_error>([&] { read(cut); }), "it is cut off before its first frame")
          << size;
      continue;
    }
    const SensLayout layout = read(cut);
    EXPECT_LT(layout.frames.size(), 2U) << size;
    EXPECT_EQ(layout.damage, "it ends within frame " + std::to_string(layout.frames.size()) + " of 2");
  }
}

TEST(SensLayout, FramesOfNoBytesAndWithoutEndAreNotCounted) {
  std::vector<SensPictures> frames = two;
  frames.push_back({{1, 0, 0, 4, 0, 1, 0, 5, 0, 0, 1, 6, 0, 0, 0, 1}, 9, "", {}});
  const SensLayout empty = read(sens_bytes(frames, 0));
  EXPECT_EQ(empty.frames.size(), 2U);
  EXPECT_EQ(empty.damage, "frame 2 has neither depth nor colours");

  const std::string bytes = sens_bytes({{{}, 1, "j", {}}, {{}, 2, "j", {}}}, 0);
  const std::size_t first = read(bytes).frames.at(0).colour.at - 96;
  std::string begin = bytes.substr(0, first);
  begin.replace(first - 8, 8, std::string(6, '\x7f') + std::string(2, '\0'));  // so many frames
  const std::string head = bytes.substr(first, 96);
  const SensLayout endless = read_sens_layout(UINT64_MAX / 2, [&](std::uint64_t at, std::size_t count) {
    return at < first ? begin.substr(at, count) : head;
  });
  EXPECT_EQ(endless.frames.size(), 1'000'000U);
  EXPECT_EQ(endless.damage, "it has more than 1,000,000 frames");
}

TEST(SensLayout, WhatIsNoneIsRefusedInAClause) {
  const auto refusal = [](std::size_t at, const std::string& with) {
    std::string bytes = sens_bytes(two);
    bytes.replace(at, with.size(), with);
    return complaint<std::runtime_error>([&] { read(bytes); });
  };
  constexpr std::size_t matrices = 4 + 8 + 15, kinds = matrices + 4 * 64;
  const std::string none(4, '\0'), many(8, '\x7f');
  EXPECT_EQ(refusal(0, "\3"), "it is not of version 4");
  EXPECT_EQ(refusal(4, many), "its sensor's name has more than 4096 letters");
  EXPECT_EQ(refusal(matrices, none), "the matrix of its colour camera is none");
  EXPECT_EQ(refusal(matrices + 128, none), "the matrix of its depth camera is none");
  EXPECT_NE(refusal(kinds + 4, "\2").find("packed in the way 2"), std::string::npos);
  EXPECT_NE(refusal(kinds + 8, none), "");
  EXPECT_EQ(refusal(kinds + 24, none), "it says no scale of its depth");
  std::string bytes = sens_bytes(two);
  bytes.replace(kinds + 28, 8, many);  // so many frames
  EXPECT_EQ(read(bytes).frames.size(), 2U);
  EXPECT_NE(read(bytes).damage.find("it ends within frame 2 of "), std::string::npos);
}

TEST(SensLayout, StepsAreUnpackedOrRefused) {
  const std::vector<std::uint16_t> steps(48 * 36, 0x0102);
  const SensLayout layout = read(sens_bytes(two));
  const std::string pgm = pgm_of_sens(packed(steps), layout);
  EXPECT_TRUE(pgm.starts_with("P5\n48 36\n65535\n\1\2\1\2"));
  EXPECT_EQ(pgm.size(), 15U + 2U * 48U * 36U);
  for (const std::string& bytes :
       {packed(std::vector<std::uint16_t>(48 * 35, 9)), packed(std::vector<std::uint16_t>(48 * 37, 9)),
        std::string("no zlib"), std::string(), packed(steps).substr(0, 9)})
    EXPECT_EQ(complaint<std::runtime_error>([&] { pgm_of_sens(bytes, layout); }), "its zlib data is damaged");
  EXPECT_EQ(complaint<std::runtime_error>([&] { pgm_of_sens("123", read(sens_bytes(two, 0))); }),
            "it has 3 bytes, expected 3456");
}

}  // namespace sens_layout_test
}  // namespace clearway
