#include "datasets/pictures/stray_folder.hpp"

#include <gtest/gtest.h>

#include "tests/datasets/complaint.hpp"
#include "tests/datasets/pictures/depth_folders.hpp"

namespace clearway {
namespace stray_folder_test {

using namespace depth_folders;

using StrayFolders = DepthFolders;

/// The app's first version has neither times nor numbers and depth as arrays, the later one pictures.
TEST_F(StrayFolders, AreReadWithCameraPosesAndConfidence) {
  for (const char* name : {"depth", "confidence"}) make(name);
  folder_.write("camera_matrix.csv", "1600, 0.0, 959.5\n0.0, 1500, 719.5\n0.0, 0.0, 1.0\n");
  const std::string poses = "1, 2, 3, -0.5, 0.5, -0.5, 0.5\n4, 2, 3, -0.5, 0.5, -0.5, 0.5\n";
  const std::string numbered =
      "timestamp, frame, x, y, z, qx, qy, qz, qw\n100.1, 000001, 4, 2, 3, -0.5, 0.5, -0.5, 0.5\n"
      "100.0, 000000, 1, 2, 3, -0.5, 0.5, -0.5, 0.5\n";
  cv::Mat confidence(36, 48, CV_8UC1, cv::Scalar(2));
  confidence.at<std::uint8_t>(0, 2) = 0;
  confidence.at<std::uint8_t>(0, 3) = 1;
  for (const bool is_first : {true, false}) {
    for (const char* number : {"000000", "000001"}) {
      const std::string place = "depth/" + std::string(number);
      std::filesystem::remove(folder_ / (place + ".png"));
      std::filesystem::remove(folder_ / (place + ".pfm"));
      if (is_first)
        folder_.write(place + ".pfm", picture_bytes(cv::Mat_<float>(36, 48, 2.0F), ".pfm"));
      else
        folder_.write(place + ".png", picture_bytes(cv::Mat(36, 48, CV_16UC1, cv::Scalar(2000)), ".png"));
    }
    folder_.write("confidence/000001.png", picture_bytes(confidence, ".png"));
    folder_.write("odometry.csv", is_first ? "x, y, z, qx, qy, qz, qw\n" + poses : numbered);
    const auto source = open(SourceOptions{});
    for (const double x : {1.0, 4.0}) {
      const auto frame = source->next();
      ASSERT_TRUE(frame);
      const auto cloud = std::get<CloudFrame>(frame->content);
      EXPECT_EQ(cloud.points.size(), x == 1.0 ? 48U * 36U : 48U * 36U - 1U);
      // the last pixel: 47 of 48 is 1919.5 of 1920's 959.5, times 1 / 40; f = 40 and 37.5
      const Eigen::Vector3d expected(x + 2.0, 2.0 - 2.0 * 23.5 / 40.0, 3.0 - 2.0 * 17.5 / 37.5);
      EXPECT_LT((cloud.world_from_sensor * cloud.points.back().cast<double>() - expected).norm(), 1e-5);
    }
    std::string told;
    for (const std::string& warning : source->warnings()) told += warning;
    EXPECT_NE(told.find("camera_matrix.csv"), std::string::npos) << told;
    EXPECT_NE(told.find("depth of no confidence"), std::string::npos) << told;
  }
  folder_.write("confidence/000001.png", depth_png(9));
  folder_.write("camera_matrix.csv", "800, 0, 480\n0, 800, 360\n0, 0, 1\n");
  EXPECT_NE(complaint([&] { open(SourceOptions{}); }).find("1920 x 1440"), std::string::npos);
}

TEST(StrayPoses, OfOtherHeadsAreNoneAndDamagedLinesAreRefused) {
  EXPECT_FALSE(parse_stray_poses("#timestamp,p_x,p_y\n", "p"));
  EXPECT_FALSE(parse_stray_poses("1 2 3 4 5 6 7 8\n", "p"));
  EXPECT_FALSE(parse_stray_poses("", "p"));
  const std::string head = "timestamp, frame, x, y, z, qx, qy, qz, qw\n",
                    line = "9, 3, 1, 2, 3, 0, 0, 0, 1\n";
  EXPECT_EQ(parse_stray_poses(head + line, "p")->poses.begin()->first, 3U);
  for (const auto& [text, expected] :
       {std::pair<std::string, std::string>{"9, 3, 1, 2, 3, 0, 0, 0\n", "line 2: expected numbers"},
        {"9, x, 1, 2, 3, 0, 0, 0, 1\n", "line 2: expected numbers"},
        {"9, 0.5, 1, 2, 3, 0, 0, 0, 1\n", "line 2: expected the whole number"},
        {"9, 3, 1, 2, 3, 0, 0, 0, 2\n", "line 2: expected a unit"},
        {line + line, "line 3: picture 3 has a second pose"}})
    EXPECT_NE(complaint([&, text = text] { parse_stray_poses(head + text, "p"); }).find(expected),
              std::string::npos)
        << text;
}

}  // namespace stray_folder_test
}  // namespace clearway
