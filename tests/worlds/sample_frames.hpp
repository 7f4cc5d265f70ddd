#pragma once

#include <random>
#include <vector>

#include "datasets/sources/frame_bytes.hpp"
#include "datasets/sources/recording.hpp"

namespace clearway {

inline Eigen::Isometry3d random_pose(std::mt19937& random) {
  std::uniform_real_distribution<double> uniform(-1, 1);
  Eigen::Isometry3d pose = Eigen::Isometry3d::Identity();
  pose.translate(Eigen::Vector3d(uniform(random), uniform(random), uniform(random)));
  pose.rotate(
      Eigen::Quaterniond(uniform(random), uniform(random), uniform(random), uniform(random)).normalized());
  return pose;
}

inline ImageFrame sample_image(std::mt19937& random, int width, int height) {
  ImageFrame frame;
  frame.image = {width, height, {}};
  for (int i = 0; i < width * height; ++i) frame.image.pixels.push_back(static_cast<uint8_t>(random()));
  frame.intrinsics = {width, height, 700.25, 701.5, 3.75, 2.5, {-0.1, 0.02, 1e-3, -2e-3, 3e-3}};
  frame.world_from_sensor = random_pose(random);
  return frame;
}

inline CloudFrame sample_cloud(std::mt19937& random, size_t size) {
  CloudFrame frame;
  std::uniform_real_distribution<float> uniform(0.1f, 3);
  for (size_t i = 0; i < size; ++i)
    frame.points.emplace_back(uniform(random), uniform(random), uniform(random));
  frame.max_range = 4.5;
  frame.kind = "points";
  frame.world_from_sensor = random_pose(random);
  return frame;
}

inline DepthImage sample_depth(std::mt19937& random, int width, int height) {
  DepthImage depth;
  depth.intrinsics = {width, height, 10, 11, width / 2.0, height / 2.0, {}};
  depth.max_range = 4;
  for (int i = 0; i < width * height; ++i)
    depth.ranges.push_back(i % 5 == 0 ? 0.0f : static_cast<float>(random() % 3000) / 1000);
  depth.world_from_sensor = random_pose(random);
  return depth;
}

/// A little of everything, without odometry (which would move the other frames).
inline std::vector<Frame> sample_frames() {
  std::mt19937 random(7);
  return {{1000.0, "setup", CommentFrame{"map: {resolution: 0.02}\n"}},
          {1000.25, "camera", sample_image(random, 8, 6)},
          {1000.5, "cloud", sample_cloud(random, 9)},
          {1000.75, "camera", sample_image(random, 8, 6)}};
}

/// The picture with a rational and a fisheye lens, and rectified.
inline std::vector<ImageFrame> images_of_other_lenses() {
  std::mt19937 random(8);
  ImageFrame rational = sample_image(random, 8, 6), fisheye = rational;
  rational.intrinsics.distortion = {0.42, -2.1, 5e-4, -3e-4, 1.3, 0.31, -1.9, 1.2};
  rational.intrinsics.lens = LensModel::rational;
  fisheye.intrinsics.distortion = {-0.012, 0.021, -0.017, 0.003};
  fisheye.intrinsics.lens = LensModel::fisheye;
  ImageFrame rectified = fisheye;
  rectified.intrinsics = {8, 6, 600.5, 601.25, 3.5, 2.25, {}};
  rectified.intrinsics.is_rectified = true;
  return {rational, fisheye, rectified};
}

inline std::string bytes_of(const Frame& frame) { return frame_to_bytes({frame, true}); }

/// All frames of a recording.
inline std::vector<Frame> read_all(RecordingReader& reader) {
  std::vector<Frame> frames;
  while (auto frame = reader.next()) frames.push_back(std::move(*frame));
  return frames;
}

}  // namespace clearway
