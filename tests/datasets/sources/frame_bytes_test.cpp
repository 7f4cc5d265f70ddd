#include "datasets/sources/frame_bytes.hpp"

#include <gtest/gtest.h>

#include "tests/worlds/sample_frames.hpp"

namespace clearway {
namespace frame_bytes_test {

TEST(FrameBytes, EveryKindOfFrameComesBack) {
  auto frames = sample_frames();
  frames.push_back({3, "odometry", OdometryFrame{std::get<CloudFrame>(frames[2].content).world_from_sensor}});
  for (const auto& frame : frames) {
    const std::string bytes = frame_to_bytes({frame, true});
    const DecodedFrame read = frame_from_bytes(bytes);
    EXPECT_TRUE(read.posed);
    EXPECT_EQ(frame_to_bytes(read), bytes);
    EXPECT_EQ(read.frame.content.index(), frame.content.index());
  }
}

TEST(FrameBytes, EveryLensComesBackAndNoOtherDoes) {
  for (const ImageFrame& image : images_of_other_lenses()) {
    std::string bytes = bytes_of({2, "camera", image});
    EXPECT_EQ(std::get<ImageFrame>(frame_from_bytes(bytes).frame.content).intrinsics, image.intrinsics);
    bytes[bytes.size() - 16 * sizeof(double) - 1] = 3;  // before the pose
    EXPECT_THROW(frame_from_bytes(bytes), std::runtime_error);
  }
}

TEST(FrameBytes, WhatACloudLeftOutComesBackToo) {
  Frame frame = sample_frames()[2];
  auto& cloud = std::get<CloudFrame>(frame.content);
  cloud.unusable = 7;
  cloud.infinite = 3;
  cloud.at_range = 2;
  cloud.is_origin_known = false;
  cloud.clear_to = {{1, 2, 3}, {4, 5, 6}};
  const auto read = std::get<CloudFrame>(frame_from_bytes(bytes_of(frame)).frame.content);
  EXPECT_EQ(read.points, cloud.points);
  EXPECT_EQ(read.unusable, 7u);
  EXPECT_EQ(read.infinite, 3u);
  EXPECT_EQ(read.at_range, 2u);
  EXPECT_FALSE(read.is_origin_known);
  EXPECT_EQ(read.clear_to, cloud.clear_to);
  cloud.clear_to[1].y() = NAN;
  EXPECT_THROW(frame_from_bytes(bytes_of(frame)), std::runtime_error);
}

TEST(FrameBytes, TimesOfPointsComeBackAndAreOfAsManyPoints) {
  Frame frame = sample_frames()[2];
  auto& cloud = std::get<CloudFrame>(frame.content);
  cloud.times.assign(cloud.points.size(), 0.25F);
  cloud.times[0] = -0.1F;
  EXPECT_EQ(std::get<CloudFrame>(frame_from_bytes(bytes_of(frame)).frame.content).times, cloud.times);
  cloud.times[0] = NAN;
  EXPECT_THROW(frame_from_bytes(bytes_of(frame)), std::runtime_error);
  cloud.times.assign(cloud.points.size() + 1, 0.0F);
  EXPECT_THROW(frame_from_bytes(bytes_of(frame)), std::runtime_error);
}

TEST(FrameBytes, NothingCutOrLengthenedIsTakenForAFrame) {
  for (const auto& frame : sample_frames()) {
    const std::string bytes = bytes_of(frame);
    for (size_t length = 0; length < bytes.size(); ++length)
      EXPECT_THROW(frame_from_bytes(std::string_view(bytes).substr(0, length)), std::runtime_error);
    EXPECT_THROW(frame_from_bytes(bytes + "x"), std::runtime_error);
  }
}

TEST(FrameBytes, RandomBytesNeverDoHarm) {
  std::mt19937 random(4);
  for (const auto& frame : sample_frames()) {
    for (int trial = 0; trial < 2000; ++trial) {
      std::string bytes = bytes_of(frame);
      for (int i = 0; i < 3; ++i) bytes[random() % bytes.size()] = static_cast<char>(random());
      try {
        const auto read = frame_from_bytes(bytes);
        if (const auto* image = std::get_if<ImageFrame>(&read.frame.content)) {
          EXPECT_EQ(image->image.pixels.size(),
                    static_cast<size_t>(image->image.width) * static_cast<size_t>(image->image.height));
        }
      } catch (const std::runtime_error&) {
      }
    }
  }
}

TEST(FrameBytes, RefusesPosesThatAreNotRigidAndNumbersThatAreNone) {
  auto frame = sample_frames()[2];
  auto& cloud = std::get<CloudFrame>(frame.content);
  const auto good = cloud;
  cloud.world_from_sensor.linear() *= 1.01;
  EXPECT_THROW(frame_from_bytes(bytes_of(frame)), std::runtime_error);
  cloud = good;
  cloud.points[3].y() = NAN;
  EXPECT_THROW(frame_from_bytes(bytes_of(frame)), std::runtime_error);
}

}  // namespace frame_bytes_test
}  // namespace clearway
