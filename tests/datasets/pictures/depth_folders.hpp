#pragma once

#include <gtest/gtest.h>

#include <memory>
#include <string>

#include "datasets/pictures/depth_folder.hpp"
#include "tests/worlds/bytes/picture_bytes.hpp"
#include "tests/worlds/temporary_folder.hpp"

namespace clearway {
namespace depth_folders {

inline const CameraIntrinsics camera{48, 36, 50, 52, 24, 18, {}};

/// A wall straight ahead, with one pixel that stands out and two that hold no depth.
inline std::string depth_png(std::uint16_t units) {
  cv::Mat depth(36, 48, CV_16UC1, cv::Scalar(units));
  depth.at<std::uint16_t>(10, 34) = static_cast<std::uint16_t>(units / 2);
  depth.at<std::uint16_t>(0, 0) = 0;
  depth.at<std::uint16_t>(0, 1) = 65535;
  return picture_bytes(depth, ".png");
}

inline SourceOptions options(double scale = 0.0002) {
  SourceOptions options;
  options.camera = camera;
  options.depth.scale = scale;
  return options;
}

class DepthFolders : public testing::Test {
 protected:
  std::unique_ptr<FrameSource> open(const SourceOptions& with) {
    const auto layout = depth_layout(folder_.path());
    EXPECT_TRUE(layout);
    return open_depth_folder(folder_.path(), *layout, with);
  }
  void make(const std::string& name) { std::filesystem::create_directory(folder_ / name); }
  TemporaryFolder folder_;
};

}  // namespace depth_folders
}  // namespace clearway
