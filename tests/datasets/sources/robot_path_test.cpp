#include "datasets/sources/robot_path.hpp"

#include <gtest/gtest.h>

#include "datasets/sources/recording.hpp"
#include "tests/worlds/sample_frames.hpp"
#include "tests/worlds/temporary_folder.hpp"

namespace clearway {
namespace robot_path_test {

Eigen::Isometry3d flat(double x, double y, double yaw) {
  Eigen::Isometry3d pose(Eigen::Translation3d(x, y, 0));
  pose.rotate(Eigen::AngleAxisd(yaw, Eigen::Vector3d::UnitZ()));
  return pose;
}

DecodedFrame odometry(double time, const Eigen::Isometry3d& pose) {
  return {{time, "odometry", OdometryFrame{pose}}, false};
}

DecodedFrame scan(double time, bool posed = false) {
  CloudFrame cloud;
  cloud.world_from_sensor = Eigen::Translation3d(0.5, 0, 0.3) * Eigen::Isometry3d::Identity();
  return {{time, "laser", cloud}, posed};
}

std::vector<Frame> placed(std::vector<DecodedFrame> frames) {
  RobotPath path;
  std::vector<Frame> result;
  const auto take_all = [&] {
    while (auto frame = path.take()) result.push_back(std::move(*frame));
  };
  for (auto& frame : frames) {
    path.add(std::move(frame));
    take_all();
  }
  path.finish();
  take_all();
  return result;
}

Eigen::Isometry3d pose_of(const Frame& frame) {
  return std::get<CloudFrame>(frame.content).world_from_sensor;
}

TEST(RobotPath, InterpolatesBetweenTheOdometryAroundAFrame) {
  const auto frames =
      placed({odometry(10, flat(1, 2, 0)), scan(10.25), odometry(11, flat(2, 4, M_PI / 2)), scan(11.5)});
  ASSERT_EQ(frames.size(), 4u);
  const Eigen::Isometry3d mount(Eigen::Translation3d(0.5, 0, 0.3));
  EXPECT_TRUE(pose_of(frames[1]).isApprox(flat(1.25, 2.5, M_PI / 8) * mount, 1e-12));
  EXPECT_TRUE(pose_of(frames[3]).isApprox(flat(2, 4, M_PI / 2) * mount, 1e-12)) << "the latest one counts";
}

TEST(RobotPath, PlacesACamerasMountAsALasers) {
  const Eigen::Isometry3d mount =
      Eigen::Translation3d(0.5, 0, 0.3) * Eigen::AngleAxisd(1.0, Eigen::Vector3d::UnitX());
  ImageFrame image;
  image.world_from_sensor = mount;
  const auto frames = placed({odometry(10, flat(1, 2, 0)), DecodedFrame{{10.25, "camera", image}, false},
                              odometry(11, flat(2, 4, M_PI / 2))});
  ASSERT_EQ(frames.size(), 3u);
  EXPECT_TRUE(std::get<ImageFrame>(frames[1].content)
                  .world_from_sensor.isApprox(flat(1.25, 2.5, M_PI / 8) * mount, 1e-12));
}

TEST(RobotPath, TurnsTheShortWay) {
  const auto frames = placed({odometry(0, flat(0, 0, 3)), scan(0.5), odometry(1, flat(0, 0, -3))});
  EXPECT_NEAR(std::abs(Eigen::AngleAxisd(pose_of(frames[1]).linear()).angle()), M_PI, 1e-9);
}

TEST(RobotPath, KeepsTheOrderAndLosesNothing) {
  std::vector<DecodedFrame> frames;
  for (int i = 0; i < 200; ++i) frames.push_back(i % 50 == 49 ? odometry(i, flat(i, 0, 0)) : scan(i));
  const auto result = placed(frames);
  ASSERT_EQ(result.size(), 200u);
  for (int i = 0; i < 200; ++i) EXPECT_EQ(result[static_cast<size_t>(i)].time, i);
}

TEST(RobotPath, FramesBeforeTheFirstOdometryAreSeenFromIt) {
  const auto frames = placed({scan(1), odometry(2, flat(7, 0, 0))});
  EXPECT_NEAR(pose_of(frames[0]).translation().x(), 7.5, 1e-12);
}

TEST(RobotPath, WithoutOdometryTheSensorPoseAloneCounts) {
  const auto frames = placed({scan(1), scan(2)});
  EXPECT_TRUE(pose_of(frames[1]).translation().isApprox(Eigen::Vector3d(0.5, 0, 0.3)));
}

TEST(RobotPath, FramesThatAreAlreadyPlacedStayWhereTheyAre) {
  const auto frames = placed({odometry(0, flat(9, 9, 1)), scan(1, true)});
  EXPECT_TRUE(pose_of(frames[1]).translation().isApprox(Eigen::Vector3d(0.5, 0, 0.3)));
}

TEST(RobotPath, FramesWithoutTimeGetTheFirstTimeThereIs) {
  const auto frames = placed({scan(DecodedFrame::unknown_time, true), scan(5, true)});
  EXPECT_EQ(frames[0].time, 5);
  EXPECT_EQ(placed({scan(DecodedFrame::unknown_time)})[0].time, 0);
}

TEST(RobotPath, OdometryInARecordingMovesItsSensors) {
  const TemporaryFolder folder;
  RecordingWriter writer(folder / "o.rawlog");
  std::mt19937 random(2);
  const CloudFrame cloud = sample_cloud(random, 4);
  writer.write({10, "odo", OdometryFrame{flat(1, 0, 0)}});
  writer.write({10.5, "cloud", cloud});
  writer.write({11, "odo", OdometryFrame{flat(3, 0, 0.2)}});
  writer.finish();
  RecordingReader reader(folder / "o.rawlog");
  const auto frames = read_all(reader);
  ASSERT_EQ(frames.size(), 3u);
  EXPECT_TRUE(pose_of(frames[1]).isApprox(flat(2, 0, 0.1) * cloud.world_from_sensor, 1e-6));
  EXPECT_EQ(reader.counts().odometry, 2u);
}

}  // namespace robot_path_test
}  // namespace clearway
