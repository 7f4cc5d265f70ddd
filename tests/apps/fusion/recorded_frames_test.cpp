#include "apps/fusion/recorded_frames.hpp"

#include <gtest/gtest.h>

#include "tests/worlds/memory_frames.hpp"
#include "tests/worlds/sample_frames.hpp"
#include "tests/worlds/temporary_folder.hpp"

namespace clearway {
namespace recorded_frames_test {

TEST(RecordedFrames, WhatIsHandedOnIsWhatTheRawlogHoldsBitForBit) {
  std::mt19937 random(5);
  std::vector<Frame> frames;
  double time = 1.7e9;
  for (int i = 0; i < 200; ++i) {
    time += 1e-3 + 1e-9 * static_cast<double>(random() % 30'000'000);
    frames.push_back({time, "camera", sample_image(random, 9, 7)});
    if (i % 5 == 0) frames.push_back({time, "lidar", sample_cloud(random, 20)});
  }
  const TemporaryFolder folder;
  std::vector<Frame> handed;
  {
    RecordedFrames source(std::make_unique<MemoryFrames>(frames), folder / "r.rawlog");
    while (auto frame = source.next()) handed.push_back(*frame);
    source.finish();
  }
  RecordingReader reader(folder / "r.rawlog");
  ASSERT_EQ(handed.size(), frames.size());
  for (const Frame& frame : handed) {
    const auto read = reader.next();
    ASSERT_TRUE(read);
    EXPECT_EQ(read->time, frame.time);
    EXPECT_EQ(read->sensor, frame.sensor);
    ASSERT_EQ(read->content.index(), frame.content.index());
    if (const auto* image = std::get_if<ImageFrame>(&frame.content)) {
      EXPECT_EQ(std::get<ImageFrame>(read->content).image, image->image);
      EXPECT_EQ(std::get<ImageFrame>(read->content).intrinsics, image->intrinsics);
    } else {
      EXPECT_EQ(std::get<CloudFrame>(read->content).points, std::get<CloudFrame>(frame.content).points);
    }
  }
  EXPECT_FALSE(reader.next());
  EXPECT_FALSE(reader.damage());
}

TEST(RecordedFrames, WithoutAnEndNothingIsLeftBehind) {
  std::mt19937 random(6);
  const TemporaryFolder folder;
  {
    RecordedFrames source(
        std::make_unique<MemoryFrames>(std::vector<Frame>{{1.0, "camera", sample_image(random, 9, 7)}}),
        folder / "r.rawlog");
    EXPECT_TRUE(source.next());
  }
  EXPECT_FALSE(std::filesystem::exists(folder / "r.rawlog"));
}

}  // namespace recorded_frames_test
}  // namespace clearway
