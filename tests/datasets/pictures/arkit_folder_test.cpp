#include "datasets/pictures/arkit_folder.hpp"

#include <gtest/gtest.h>

#include <sstream>

#include "datasets/pictures/name_time.hpp"
#include "tests/datasets/complaint.hpp"
#include "tests/datasets/pictures/depth_folders.hpp"

namespace clearway {
namespace arkit_folder_test {

using namespace depth_folders;

using ArkitFolders = DepthFolders;

/// A camera at (1, 2, 3) that looks along the world's x: z of the optical frame is x, x is -y, y is -z.
/// The line leads from the world to the camera.
std::string line_of(double time) {
  Eigen::Isometry3d pose = Eigen::Isometry3d::Identity();
  pose.linear() << 0, 0, 1, -1, 0, 0, 0, -1, 0;
  pose.translation() = Eigen::Vector3d(1, 2, 3);
  const Eigen::Isometry3d inverse = pose.inverse();
  const Eigen::AngleAxisd turn(inverse.linear());
  std::ostringstream text;
  text.precision(12);
  text << std::fixed << time << ' ' << (turn.angle() * turn.axis()).transpose() << ' '
       << inverse.translation().transpose() << '\n';
  return text.str();
}

TEST_F(ArkitFolders, EachPictureHasThePoseAndTheCameraOfItsTime) {
  for (const char* name : {"lowres_depth", "lowres_wide_intrinsics"}) make(name);
  for (const char* time : {"3000.000", "3000.100"})
    folder_.write("lowres_depth/40753679_" + std::string(time) + ".png", depth_png(2000));
  folder_.write("lowres_wide.traj", line_of(2999.9) + line_of(3000.0) + line_of(3000.1));
  folder_.write("lowres_wide_intrinsics/40753679_3000.001.pincam", "48 36 50 52 24 18");
  folder_.write("lowres_wide_intrinsics/40753679_3000.100.pincam", "48 36 100 104 24 18");
  SourceOptions none;
  const auto source = open(none);
  for (const double focal : {50.0, 100.0}) {
    const auto frame = source->next();
    ASSERT_TRUE(frame);
    const auto cloud = std::get<CloudFrame>(frame->content);
    // the pixel (34, 10) at half the depth, 1 m: optical (10 / fx, -8 / fy, 1)
    const Eigen::Vector3d expected(1.0 + 1.0, 2.0 - 10.0 / focal, 3.0 + 8.0 / (1.04 * focal));
    EXPECT_LT((cloud.world_from_sensor * cloud.points[10 * 48 + 34 - 2].cast<double>() - expected).norm(),
              1e-6);
  }
  EXPECT_FALSE(source->next());
  ASSERT_EQ(source->warnings().size(), 2U);
  EXPECT_NE(source->warnings()[0].find("lowres_wide_intrinsics"), std::string::npos);
  EXPECT_NE(source->warnings()[1].find("0.001 m"), std::string::npos);
  std::filesystem::remove(folder_ / "lowres_wide_intrinsics/40753679_3000.100.pincam");
  EXPECT_EQ(complaint([&] { open(none); }), "");  // the nearest one
  folder_.write("lowres_depth/40753679_3001.200.png", depth_png(2000));
  EXPECT_NE(complaint([&] { open(none); }).find("3001.200.png' has no camera"), std::string::npos);
  std::filesystem::remove(folder_ / "lowres_depth/40753679_3001.200.png");
  folder_.write("lowres_wide_intrinsics/40753679_3000.100.pincam", "48 36 100 104 24");
  EXPECT_NE(complaint([&] { open(none); }).find("expected six numbers"), std::string::npos);
}

TEST(ArkitPoses, AreLinesOfSevenNumbersInATraj) {
  EXPECT_TRUE(is_arkit_poses("a/lowres_wide.traj", "1 2 3 4 5 6 7\n"));
  EXPECT_FALSE(is_arkit_poses("a/lowres_wide.traj", "1 2 3 4 5 6 7 8\n"));  // TUM's
  EXPECT_FALSE(is_arkit_poses("a/poses.txt", "1 2 3 4 5 6 7\n"));
}

TEST(ArkitPoses, LinesOfOtherNumbersAreRefused) {
  for (const char* text : {"1 2 3 4 5 6\n", "1 2 3 4 5 6 x\n", "1 0 0 0 0 0 0\n1 2 3 4 5 6 7 8\n"})
    EXPECT_NE(complaint([&] { tum_of_arkit(text, "p"); }).find("seven numbers"), std::string::npos) << text;
  EXPECT_EQ(tum_of_arkit("5 0 0 0 1 2 3\n", "p"), "5 -1 -2 -3 0 0 0 1\n");
}

TEST(ArkitPoses, TimesInNamesAreSecondsBehindTheRecordingsNumber) {
  EXPECT_EQ(time_in_name("47331606_74.512"), 74.512);
  EXPECT_EQ(time_in_name("41048190_123456.789"), 123456.789);
  EXPECT_EQ(time_in_name("20261123_071530.250"), *seconds_of_date(2026, 11, 23, 7, 15, 30) + 0.25);
  EXPECT_FALSE(time_in_name("4733160_74.512"));
}

}  // namespace arkit_folder_test
}  // namespace clearway
