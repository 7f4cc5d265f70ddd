#include "datasets/pictures/polycam_path.hpp"

#include <gtest/gtest.h>

#include <filesystem>

#include "datasets/pictures/picture_times.hpp"
#include "tests/datasets/complaint.hpp"
#include "tests/datasets/pictures/depth_folders.hpp"

namespace clearway {
namespace polycam_path_test {

using namespace depth_folders;

/// Of a camera at (x, 2, 3) that looks along +x of ARKit's world, its own y up as the world's.
std::string camera_at(double x, const std::string& more = "") {
  return R"({"t_00": 0, "t_01": 0, "t_02": -1, "t_03": )" + std::to_string(x) +
         R"(, "t_10": 0, "t_11": 1, "t_12": 0, "t_13": 2, "t_20": 1, "t_21": 0, "t_22": 0, "t_23": 3,
         "fx": 160, "fy": 150, "cx": 95.5, "cy": 71.5, "width": 192, "height": 144,
         "timestamp": 99510474, "blur_score": 90.5)" +
         more + "}";
}

class PolycamFolders : public DepthFolders {
 protected:
  void SetUp() override {
    for (const char* name :
         {"keyframes", "keyframes/depth", "keyframes/images", "keyframes/cameras", "keyframes/confidence"})
      make(name);
    for (const char* picture : {"99510474", "99843011", "100210000"}) {
      const std::string name(picture);
      folder_.write("keyframes/depth/" + name + ".png",
                    picture_bytes(cv::Mat(36, 48, CV_16UC1, cv::Scalar(2000)), ".png"));
      folder_.write("keyframes/images/" + name + ".jpg",
                    picture_bytes(cv::Mat(144, 192, CV_8UC3, cv::Scalar(9, 9, 9)), ".jpg"));
    }
    cv::Mat confidence(36, 48, CV_8UC1, cv::Scalar(255));
    confidence.at<std::uint8_t>(0, 2) = 0;
    confidence.at<std::uint8_t>(0, 3) = 127;
    folder_.write("keyframes/confidence/99843011.png", picture_bytes(confidence, ".png"));
    folder_.write("thumbnail.jpg", picture_bytes(cv::Mat(9, 9, CV_8UC3, cv::Scalar(9, 9, 9)), ".jpg"));
    folder_.write("mesh_info.json", "{}");
    for (const auto& [name, x] : {std::pair{"99510474", 1.0}, {"99843011", 4.0}, {"100210000", 5.0}})
      folder_.write("keyframes/cameras/" + std::string(name) + ".json", camera_at(x));
  }

  /// Where the sensor was at each depth picture that has a pose.
  static std::vector<double> places(FrameSource& source) {
    std::vector<double> result;
    while (const auto frame = source.next())
      if (const auto* cloud = std::get_if<CloudFrame>(&frame->content))
        result.push_back(cloud->world_from_sensor.translation().x());
    return result;
  }
};

TEST_F(PolycamFolders, AreReadWithEachPicturesCameraAndPose) {
  const auto source = open(SourceOptions{});
  std::vector<std::size_t> counts;
  while (const auto frame = source->next()) {
    const auto* cloud = std::get_if<CloudFrame>(&frame->content);
    if (cloud == nullptr) continue;
    counts.push_back(cloud->points.size());
    EXPECT_NEAR(frame->time, counts.size() == 1 ? 99.510474 : counts.size() == 2 ? 99.843011 : 100.21, 1e-9);
    const double x = counts.size() == 1 ? 1.0 : counts.size() == 2 ? 4.0 : 5.0;
    // The last pixel, 23.5 and 17.5 beside the middle at f = 40 and 37.5: right is +z there, down is -y.
    const Eigen::Vector3d expected(x + 2.0, 2.0 - 2.0 * 17.5 / 37.5, 3.0 + 2.0 * 23.5 / 40.0);
    const Eigen::Vector3d last = cloud->world_from_sensor * cloud->points.back().cast<double>();
    EXPECT_LT((last - expected).norm(), 1e-5) << last.transpose();
  }
  EXPECT_EQ(counts, (std::vector<std::size_t>{48 * 36, 48 * 36 - 1, 48 * 36}));
  std::string told;
  for (const std::string& warning : source->warnings()) told += warning + '\n';
  EXPECT_NE(told.find("keyframes/cameras"), std::string::npos) << told;
  EXPECT_EQ(told.find("nothing states"), std::string::npos) << told;
  EXPECT_EQ(source->time_caveat(), "");
}

TEST_F(PolycamFolders, CorrectedCamerasCountAndWhatLacksThereIsLeftOut) {
  make("keyframes/corrected_cameras");
  folder_.write("keyframes/corrected_cameras/99510474.json", camera_at(7.0));
  folder_.write("keyframes/corrected_cameras/99843011.json", camera_at(8.0));
  const auto source = open(SourceOptions{});
  EXPECT_EQ(places(*source), (std::vector<double>{7.0, 8.0}));
  std::string told;
  for (const std::string& warning : source->warnings()) told += warning + '\n';
  EXPECT_NE(told.find("1 of 3 depth pictures"), std::string::npos) << told;
  EXPECT_NE(told.find("corrected_cameras"), std::string::npos) << told;
}

TEST_F(PolycamFolders, WhatIsNoCameraIsRefusedByItsFileAndField) {
  const auto refusal = [&](const std::string& camera) {
    folder_.write("keyframes/cameras/99843011.json", camera);
    return complaint([&] { open(SourceOptions{}); });
  };
  const auto changed = [](const std::string& from, const std::string& to) {
    std::string text = camera_at(1.0);
    return text.replace(text.find(from), from.size(), to);
  };
  for (const auto& [camera, expected] :
       {std::pair<std::string, std::string>{changed("\"t_00\": 0", "\"t_00\": 0.5"), "a rotation"},
        {changed("\"t_12\": 0, ", ""), "t_12"},
        {changed("160", "-160"), "fx"},
        {changed("\"height\": 144", "\"height\": 192"), "48 x 36"},
        {camera_at(1.0, ",,"), "JSON"}}) {
    const std::string said = refusal(camera);
    EXPECT_NE(said.find("keyframes/cameras/99843011.json'"), std::string::npos) << said;
    EXPECT_NE(said.find(expected), std::string::npos) << said;
  }
}

TEST_F(PolycamFolders, FilesOfAnotherProgramAreNoneOfIts) {
  for (const char* picture : {"99510474", "99843011", "100210000"})
    std::filesystem::remove(folder_ / ("keyframes/cameras/" + std::string(picture) + ".json"));
  EXPECT_TRUE(polycam_cameras(folder_ / "keyframes").empty());
  EXPECT_FALSE(depth_layout(folder_.path()));
  for (const std::string& text : {std::string("{\"fx\": 1}"), std::string(100'000, ' ') + camera_at(1.0)}) {
    folder_.write("keyframes/cameras/all.json", text);
    EXPECT_TRUE(polycam_cameras(folder_ / "keyframes").empty());
    EXPECT_EQ(times_of_files({folder_ / "keyframes/images/99510474.jpg"}, std::nullopt).files.size(), 1U);
  }
}

}  // namespace polycam_path_test
}  // namespace clearway
