#include "datasets/ros/sensor_frames.hpp"

#include <gtest/gtest.h>

#include <cstring>
#include <opencv2/calib3d.hpp>

namespace clearway {
namespace sensor_frames_test {

RosCameraInfo info_of(const std::string& model, const std::vector<double>& d) {
  RosCameraInfo info;
  info.width = 64;
  info.height = 48;
  info.distortion_model = model;
  info.d = d;
  info.k = {20, 0, 31.5, 0, 21, 23.5, 0, 0, 1};
  return info;
}

std::string refusal_of(const RosCameraInfo& info) {
  try {
    intrinsics_of(info);
  } catch (const std::runtime_error& error) {
    return error.what();
  }
  return "";
}

TEST(SensorFrames, CameraInfoNamesItsLens) {
  CameraIntrinsics expected{64, 48, 20, 21, 31.5, 23.5, {0.1, 0.2, 0.3, 0.4, 0.5, 0.6, 0.7, 0.8}};
  expected.lens = LensModel::rational;
  EXPECT_EQ(intrinsics_of(info_of("rational_polynomial", {0.1, 0.2, 0.3, 0.4, 0.5, 0.6, 0.7, 0.8})),
            expected);
  EXPECT_EQ(intrinsics_of(info_of("rational_polynomial",  // as of an OAK-D
                                  {0.1, 0.2, 0.3, 0.4, 0.5, 0.6, 0.7, 0.8, 0, 0, 0, 0, 0, 0})),
            expected);
  expected.lens = LensModel::fisheye;
  expected.distortion = {0.1, 0.2, 0.3, 0.4};
  for (const char* name : {"equidistant", "fisheye"}) {
    EXPECT_EQ(intrinsics_of(info_of(name, {0.1, 0.2, 0.3, 0.4})), expected);
    EXPECT_EQ(intrinsics_of(info_of(name, {0.1, 0.2, 0.3, 0.4, 0})), expected);  // as of a T265
  }
  expected.distortion = {};
  EXPECT_EQ(intrinsics_of(info_of("equidistant", {0, 0, 0, 0})), expected);
  expected.lens = LensModel::plumb_bob;
  EXPECT_EQ(intrinsics_of(info_of("", {})), expected);
  expected.distortion = {0.1, 0.2, 0.3, 0.4, 0.5};
  EXPECT_EQ(intrinsics_of(info_of("plumb_bob", {0.1, 0.2, 0.3, 0.4, 0.5})), expected);
  EXPECT_EQ(intrinsics_of(info_of("rational_polynomial", {0.1, 0.2, 0.3, 0.4, 0.5, 0, 0, 0})), expected);
}

TEST(SensorFrames, OtherLensesAreRefusedWithThoseThatAreKnown) {
  const std::string other = refusal_of(info_of("omni", {0.1}));
  EXPECT_NE(other.find("'omni' is not known here, expected plumb_bob"), std::string::npos) << other;
  const std::string few = refusal_of(info_of("equidistant", {}));
  EXPECT_NE(few.find("has 0 numbers, expected k1, k2, k3, k4"), std::string::npos) << few;
  const std::string many = refusal_of(info_of("equidistant", {0.1, 0, 0, 0, 0.5}));
  EXPECT_NE(many.find("does not fit 'equidistant': expected 4 numbers"), std::string::npos) << many;
  const std::string prism =
      refusal_of(info_of("rational_polynomial", {0.1, 0, 0, 0, 0.5, 0.1, 0.1, 0.1, 0.01, 0, 0, 0}));
  EXPECT_NE(prism.find("expected 8 numbers"), std::string::npos) << prism;
}

TEST(SensorFrames, DepthImagesOfAFisheyeLieOnTheRaysThatOpenCvFinds) {
  const RosCameraInfo info = info_of("equidistant", {0.01, -0.02, 0.003, 0.001});
  std::vector<std::uint8_t> data(64 * 48 * 2);
  std::vector<cv::Point2d> pixels, rays;
  for (int row = 0; row < 48; ++row)
    for (int column = 0; column < 64; ++column) {
      const bool is_measured = std::hypot((column - 31.5) / 20, (row - 23.5) / 21) < 1.3;
      const std::uint16_t depth = is_measured ? static_cast<std::uint16_t>(500 + row) : 0;
      std::memcpy(&data[static_cast<std::size_t>(2 * (64 * row + column))], &depth, 2);
      if (is_measured) pixels.emplace_back(column, row);
    }
  cv::fisheye::undistortPoints(pixels, rays, cv::Matx33d(20, 0, 31.5, 0, 21, 23.5, 0, 0, 1), info.d);
  RosImage image;
  image.width = 64;
  image.height = 48;
  image.step = 128;
  image.encoding = "16UC1";
  image.data = data;
  const CameraIntrinsics camera = intrinsics_of(info);
  const CloudFrame cloud = depth_cloud(image, camera, depth_rays(camera));
  ASSERT_EQ(cloud.points.size(), rays.size());
  for (std::size_t i = 0; i < rays.size(); ++i) {
    const double depth = 0.5 + 0.001 * pixels[i].y;
    const Eigen::Vector3d expected(depth, -depth * rays[i].x, -depth * rays[i].y);
    EXPECT_LT((cloud.points[i].cast<double>() - expected).norm(), 2e-5) << i;
  }
}

}  // namespace sensor_frames_test
}  // namespace clearway
