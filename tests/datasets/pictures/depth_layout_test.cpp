// What of a folder is read where it has two of something.
#include "datasets/pictures/depth_layout.hpp"

#include "datasets/camera_files/camera_file.hpp"
#include "tests/datasets/pictures/depth_folders.hpp"

namespace clearway {
namespace depth_layout_test {

using namespace depth_folders;

class DepthLayouts : public DepthFolders {};

TEST_F(DepthLayouts, OfTwoFoldersAndTwoSourcesOfPosesTheOnesThatAreReadAreNamed) {
  for (const char* name : {"depth", "aligned_depth", "pose"}) make(name);
  for (const char* name : {"depth/0.png", "aligned_depth/0.png"}) folder_.write(name, depth_png(10000));
  folder_.write("pose/0.txt", "1 0 0 9\n0 1 0 0\n0 0 1 0\n0 0 0 1\n");
  folder_.write("trajectory.txt", "0 1 2 3 0 0 0 1\n");
  const auto source = open(options());
  const auto frame = source->next();
  ASSERT_TRUE(frame);
  EXPECT_EQ(std::get<CloudFrame>(frame->content).world_from_sensor.translation(), Eigen::Vector3d(1, 2, 3));
  std::string told;
  for (const std::string& warning : source->warnings()) told += warning + "\n";
  EXPECT_NE(told.find("depth pictures are those of 'depth'; those of 'aligned_depth' beside it are not read"),
            std::string::npos)
      << told;
  EXPECT_NE(told.find("poses are those of 'trajectory.txt'; those of 'pose' beside it are not read"),
            std::string::npos)
      << told;
}

TEST_F(DepthLayouts, ArraysOfPosesAreFoundBehindTexts) {
  make("depth");
  folder_.write("depth/0.png", depth_png(1000));
  folder_.write("poses.npy", "");
  EXPECT_EQ(depth_layout(folder_.path())->poses, folder_ / "poses.npy");
  folder_.write("images.txt", "1 1 0 0 0 -4 0 0 1 0.png\n\n");
  folder_.write("cameras.txt", "1 PINHOLE 48 36 50 52 24 18\n");
  EXPECT_EQ(depth_layout(folder_.path())->poses, folder_ / "images.txt");
  EXPECT_EQ(depth_layout(folder_.path())->camera, folder_ / "cameras.txt");
  folder_.write("traj.txt", "1 0 0 4 0 1 0 5 0 0 1 6\n");
  EXPECT_EQ(depth_layout(folder_.path())->poses, folder_ / "traj.txt");
  SourceOptions options;
  options.depth.camera = camera;
  const auto source = open(options);
  std::string told;
  for (const std::string& warning : source->warnings()) told += warning + "\n";
  EXPECT_NE(told.find("poses are those of 'traj.txt'; those of 'poses.npy' beside it are not read"),
            std::string::npos)
      << told;
}

TEST_F(DepthLayouts, ConfidenceIsThatOfTheDepthBesideIt) {
  for (const char* name : {"arkit_depth", "gt_depth"}) make(name);
  folder_.write("gt_depth/0.png", depth_png(1000));
  folder_.write("arkit_depth/0_conf.png", depth_png(1000));
  EXPECT_EQ(depth_layout(folder_.path())->depth.front(), folder_ / "gt_depth/0.png");
  EXPECT_TRUE(depth_layout(folder_.path())->confidence.empty());
  folder_.write("arkit_depth/0.png", depth_png(1000));
  EXPECT_EQ(depth_layout(folder_.path())->confidence, folder_ / "arkit_depth");
}

/// As gradslam and NICE-SLAM write it.
TEST_F(DepthLayouts, StepsInAMetreOfTheCamerasFileAreTheScale) {
  const std::string file = folder_.write(
      "camera.yaml",
      "camera_params:\n  image_height: 36\n  image_width: 48\n  fx: 50\n  fy: 52\n  cx: 24\n  cy: 18\n"
      "  png_depth_scale: 6553.5\n");
  EXPECT_NEAR(depth_scale_of_file(file).value(), 1.0 / 6553.5, 1e-12);
}

}  // namespace depth_layout_test
}  // namespace clearway
