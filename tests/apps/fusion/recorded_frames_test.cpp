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
    const clearway::Setup setup;
    RecordedFrames source(std::make_unique<MemoryFrames>(frames), folder / "r.rawlog", setup);
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

/// A robot with odometry drives, and its laser is known by its kind: the rawlog says where each scan was
/// taken, once, and by which sensor of the setup.
TEST(RecordedFrames, ScansOfAMovingRobotAreReadBackInTheirPlaces) {
  std::mt19937 random(7);
  std::vector<Frame> frames;
  for (int i = 0; i < 20; ++i) {
    Eigen::Isometry3d world_from_robot(Eigen::AngleAxisd(0.1 * i, Eigen::Vector3d::UnitZ()));
    world_from_robot.translation().x() = 0.5 * i;
    frames.push_back({1.7e9 + i, "", OdometryFrame{world_from_robot}});
    CloudFrame cloud = sample_cloud(random, 20);
    cloud.kind = "laser2d";
    cloud.world_from_sensor = world_from_robot;
    frames.push_back({1.7e9 + i + 0.5, "LASER1", cloud});
  }
  clearway::Setup setup;
  setup.sensors.resize(1);
  setup.sensors[0].name = "laser2d";
  const TemporaryFolder folder;
  std::vector<Frame> handed;
  {
    RecordedFrames source(std::make_unique<MemoryFrames>(frames), folder / "r.rawlog", setup);
    while (auto frame = source.next()) handed.push_back(*frame);
    source.finish();
  }
  ASSERT_EQ(handed.size(), 20U);
  RecordingReader reader(folder / "r.rawlog");
  for (const Frame& frame : handed) {
    const auto read = reader.next();
    ASSERT_TRUE(read);
    const auto &cloud = std::get<CloudFrame>(frame.content), &again = std::get<CloudFrame>(read->content);
    EXPECT_TRUE(again.world_from_sensor.isApprox(cloud.world_from_sensor, 1e-12));
    EXPECT_EQ(setup.sensor(read->sensor, again.kind), &setup.sensors[0]);
    EXPECT_EQ(setup.sensor(frame.sensor, cloud.kind), &setup.sensors[0]);
  }
  EXPECT_FALSE(reader.next());
}

TEST(RecordedFrames, WithoutAnEndWhatWasHandedOnIsThere) {
  std::mt19937 random(6);
  const TemporaryFolder folder;
  const clearway::Setup setup;
  {
    RecordedFrames source(
        std::make_unique<MemoryFrames>(std::vector<Frame>{{1.0, "camera", sample_image(random, 9, 7)}}),
        folder / "r.rawlog", setup);
    EXPECT_TRUE(source.next());
  }
  RecordingReader reader(folder / "r.rawlog");
  EXPECT_TRUE(reader.next());
  EXPECT_FALSE(reader.next());
  ASSERT_TRUE(reader.damage());  // which is that its end is missing
}

}  // namespace recorded_frames_test
}  // namespace clearway
