#include "datasets/ros/sensor_frames.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <opencv2/calib3d.hpp>
#include <random>

#include "datasets/ros/ros_camera.hpp"
#include "datasets/sources/lens.hpp"
#include "tests/datasets/complaint.hpp"

namespace clearway {
namespace sensor_frames_test {

TEST(SensorFrames, DepthImagesOfAFisheyeLieOnTheRaysThatOpenCvFinds) {
  RosCameraInfo info;
  info.width = 64;
  info.height = 48;
  info.distortion_model = "equidistant";
  info.d = {0.01, -0.02, 0.003, 0.001};
  info.k = {20, 0, 31.5, 0, 21, 23.5, 0, 0, 1};
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
  const CameraIntrinsics camera = raw_camera(info).intrinsics;
  const CloudFrame cloud = depth_cloud(image, camera, depth_rays(camera));
  ASSERT_EQ(cloud.points.size(), rays.size());
  for (std::size_t i = 0; i < rays.size(); ++i) {
    const double depth = 0.5 + 0.001 * pixels[i].y;
    const Eigen::Vector3d expected(depth, -depth * rays[i].x, -depth * rays[i].y);
    EXPECT_LT((cloud.points[i].cast<double>() - expected).norm(), 2e-5) << i;
  }
}

/// Stereo cameras and decimating filters write 65535 where there is no return.
TEST(SensorFrames, SaturatedDepthIsNoReturn) {
  RosImage image;
  image.width = 3;
  image.height = 1;
  image.encoding = "16UC1";
  const CameraIntrinsics camera{3, 1, 10, 10, 1, 0, {}};
  for (const bool is_bigendian : {false, true}) {
    std::vector<std::uint8_t> data{0xFF, 0xFF, 0xE8, 0x03, 0xFE, 0xFF};  // 65535, 1000, 65534
    for (std::size_t i = 0; is_bigendian && i < data.size(); i += 2) std::swap(data[i], data[i + 1]);
    image.is_bigendian = is_bigendian;
    image.step = 6;
    image.data = data;
    const CloudFrame cloud = depth_cloud(image, camera, depth_rays(camera));
    ASSERT_EQ(cloud.points.size(), 2U);
    EXPECT_FLOAT_EQ(cloud.points[0].x(), 1.0F);
    EXPECT_FLOAT_EQ(cloud.points[1].x(), 65.534F);
  }
}

TEST(SensorFrames, LaserScansWhoseBeamsCanBeNowhereAreRefused) {
  RosLaserScan fine;
  fine.angle_min = -3.14F;
  fine.angle_max = 3.14F;
  fine.angle_increment = 6.28F / 359.0F;
  fine.range_max = 10.0F;
  fine.ranges.assign(360, 2.0F);
  EXPECT_EQ(laser_cloud(fine, false).points.size(), 360U);
  EXPECT_FALSE(has_opposite_angles(fine));
  const auto refusal = [&](auto change) {
    RosLaserScan scan = fine;
    change(scan);
    return complaint<std::runtime_error>([&] { laser_cloud(scan, false); });
  };
  EXPECT_NE(refusal([](RosLaserScan& scan) { scan.angle_increment = 0.0F; }).find("angle_increment is 0"),
            std::string::npos);
  EXPECT_NE(refusal([](RosLaserScan& scan) { scan.angle_increment = 1.0F; }).find("are its angles degrees?"),
            std::string::npos);
  for (const float range : {0.0F, -1.0F, std::nanf("")})
    EXPECT_NE(refusal([&](RosLaserScan& scan) { scan.range_max = range; }).find("its range_max is "),
              std::string::npos);
  EXPECT_EQ(refusal([](RosLaserScan& scan) { scan.range_max = HUGE_VALF; }), "");
  EXPECT_EQ(refusal([](RosLaserScan& scan) { scan.ranges.push_back(2.0F); }), "") << "both ends of a turn";
  RosLaserScan turned = fine;
  turned.angle_increment = -turned.angle_increment;
  EXPECT_TRUE(has_opposite_angles(turned));
  std::swap(turned.angle_min, turned.angle_max);
  EXPECT_FALSE(has_opposite_angles(turned));
  RosLaserScan back = fine;  // from 2 rad over pi to -2 rad
  back.angle_min = 2.0F;
  back.angle_max = -2.0F;
  back.ranges.assign(101, 2.0F);
  back.angle_increment = static_cast<float>((2.0 * M_PI - 4.0) / 100.0);
  EXPECT_FALSE(has_opposite_angles(back));
  back.angle_increment = 0.0F;
  EXPECT_FALSE(has_opposite_angles(back));
  turned.ranges.resize(1);
  turned.angle_max = turned.angle_min;
  EXPECT_FALSE(has_opposite_angles(turned));
}

/// Two pixels each: the brightness stands first in YUYV and second in UYVY; of 8UC4 it is made of all three.
TEST(SensorFrames, ImagesOfPackedColoursAreTheirBrightness) {
  for (const auto& [encoding, bytes] : std::vector<std::pair<std::string, std::vector<std::uint8_t>>>{
           {"YUYV", {10, 128, 20, 128}},
           {"yuv422_yuy2", {10, 128, 20, 128}},
           {"yuv422", {128, 10, 128, 20}},
           {"8UC4", {10, 10, 10, 255, 20, 20, 20, 255}}}) {
    RosImage image;
    image.width = 2;
    image.height = 1;
    image.step = static_cast<std::uint32_t>(bytes.size());
    image.encoding = encoding;
    image.data = bytes;
    EXPECT_EQ(gray_image(image).pixels, (std::vector<std::uint8_t>{10, 20})) << encoding;
  }
}

/// Two points as of ouster_ros and others. @param kind of the time's field: 6 is uint32, 7 float32
PointTimes times_of(const std::string& field, std::uint8_t kind, double from, double to) {
  static std::vector<std::uint8_t> data;
  data.assign(32, 0);
  for (const auto& [at, time] : {std::pair{0U, from}, std::pair{16U, to}}) {
    const float x = 1.0F, as_float = static_cast<float>(time);
    const auto whole = static_cast<std::uint32_t>(time);
    std::memcpy(&data[at], &x, 4);
    std::memcpy(&data[at + 12], kind == 7 ? static_cast<const void*>(&as_float) : &whole, 4);
  }
  RosPointCloud cloud;
  cloud.header.time = 100.0;
  cloud.fields = {{"x", 0, 1, 7}, {"y", 4, 1, 7}, {"z", 8, 1, 7}, {field, 12, 1, kind}};
  cloud.width = 2;
  cloud.height = 1;
  cloud.point_step = 16;
  cloud.row_step = 0;  // left unset, as some do of one row
  cloud.data = data;
  EXPECT_EQ(points_cloud(cloud).points.size(), 2U);
  return point_times(cloud).value();
}

/// `at` the coordinates of a cloud, in the order of bytes that is said, or in the other one.
bool is_other_order(const std::vector<Eigen::Vector3f>& at, bool is_big, bool says_big) {
  std::vector<std::uint8_t> data(12 * at.size());
  for (std::size_t i = 0; i < at.size(); ++i)
    for (int axis = 0; axis < 3; ++axis) {
      std::uint8_t* number = &data[12 * i + 4 * static_cast<std::size_t>(axis)];
      std::memcpy(number, &at[i][axis], 4);
      if (is_big) std::reverse(number, number + 4);
    }
  RosPointCloud cloud;
  cloud.fields = {{"x", 0, 1, 7}, {"y", 4, 1, 7}, {"z", 8, 1, 7}};
  cloud.width = static_cast<std::uint32_t>(at.size());
  cloud.height = 1;
  cloud.point_step = 12;
  cloud.row_step = 12 * cloud.width;
  cloud.is_bigendian = says_big;
  cloud.data = data;
  return has_other_order(cloud);
}

TEST(SensorFrames, AnOrderOfBytesInWhichPointsMakeNoSenseIsNoticed) {
  std::mt19937 random(3);
  std::uniform_real_distribution<float> near(-4.0F, 4.0F);
  std::vector<Eigen::Vector3f> room, sparse(5000, Eigen::Vector3f::Constant(NAN)),
      zeros(10, Eigen::Vector3f(0, 0, 0));
  for (int i = 0; i < 5000; ++i) room.emplace_back(near(random), near(random), near(random));
  std::vector<Eigen::Vector3f> mostly_none(5000, Eigen::Vector3f(0, 0, 0));
  for (std::size_t i = 0; i < sparse.size(); i += 10) mostly_none[i] = sparse[i] = room[i];
  std::vector<Eigen::Vector3f> earth, flat, tiny;  // of map projections, and of a microscope
  std::uniform_real_distribution<float> far(3e6F, 6e6F), small(-1e-5F, 1e-5F);
  for (int i = 0; i < 5000; ++i) {
    earth.emplace_back(far(random), far(random), far(random));
    flat.emplace_back(far(random), far(random), 0.0F);
    tiny.emplace_back(small(random), small(random), small(random));
  }
  for (const auto* cloud : {&earth, &flat, &tiny})
    for (const bool is_big : {false, true}) EXPECT_FALSE(is_other_order(*cloud, is_big, is_big));
  for (const bool is_big : {false, true})
    for (const bool says_big : {false, true}) {
      EXPECT_EQ(is_other_order(room, is_big, says_big), is_big != says_big);
      EXPECT_EQ(is_other_order(sparse, is_big, says_big), is_big != says_big);
      EXPECT_EQ(is_other_order(mostly_none, is_big, says_big), is_big != says_big);
      EXPECT_FALSE(is_other_order(zeros, is_big, says_big));
      EXPECT_FALSE(is_other_order({}, is_big, says_big));
      EXPECT_FALSE(is_other_order({5, Eigen::Vector3f::Constant(NAN)}, is_big, says_big));
    }
}

/// A packet of a sweep spans less than a sweep does: 0.37 ms would be 0.37 s of microseconds.
TEST(SensorFrames, TimesOfPointsOfDriversThatCountNanosecondsAreThese) {
  for (const char* field : {"t", "offset_time"})
    for (const double span : {1e8, 370'000.0, 20'000.0})
      EXPECT_NEAR(times_of(field, 6, 1000, 1000 + span).times.at(1), (1000 + span) * 1e-9, 1e-12) << span;
  EXPECT_NEAR(times_of("time", 7, 0, 0.1).times.at(1), 0.1, 1e-8);
  EXPECT_NEAR(times_of("timestamp", 6, 0, 100'000).times.at(1), 0.1, 1e-9);  // us
}

TEST(SensorFrames, OfALasersBeamsInfinityMetNothingAndNanSaysNothing) {
  const std::vector<float> ranges{1.0F, INFINITY, NAN, -INFINITY, 0.0F, -1.0F, 0.05F, INFINITY};
  RosLaserScan scan;
  scan.angle_min = 0.0F;
  scan.angle_increment = 0.5F;
  scan.range_min = 0.1F;
  scan.range_max = 8.0F;
  scan.ranges.assign(ranges.begin(), ranges.end());
  const CloudFrame plain = laser_cloud(scan, false), clear = laser_cloud(scan, true);
  EXPECT_EQ(plain.points, (std::vector<Eigen::Vector3f>{{1, 0, 0}}));
  EXPECT_EQ(clear.points, plain.points);
  EXPECT_TRUE(plain.clear_to.empty());
  EXPECT_EQ(plain.infinite, 2U);
  EXPECT_EQ(clear.infinite, 2U);
  ASSERT_EQ(clear.clear_to.size(), 2U);
  for (const auto& [i, beam] : {std::pair{0, 1}, {1, 7}}) {
    const Eigen::Vector3d expected(8.0 * std::cos(0.5 * beam), 8.0 * std::sin(0.5 * beam), 0);
    EXPECT_LT((clear.clear_to[static_cast<std::size_t>(i)].cast<double>() - expected).norm(), 1e-6);
  }
  scan.range_max = INFINITY;
  EXPECT_TRUE(laser_cloud(scan, true).clear_to.empty());
  EXPECT_EQ(laser_cloud(scan, true).infinite, 2U);
}

TEST(SensorFrames, OfALasersBeamsItsLargestRangeAndMoreMetNothing) {
  RosLaserScan scan;
  scan.angle_increment = 0.5F;
  scan.range_min = 0.1F;
  scan.range_max = 8.1F;
  scan.ranges = {8.1F, 1.0F, std::nextafter(8.1F, 0.0F), 9.0F, INFINITY};
  const CloudFrame plain = laser_cloud(scan, false), clear = laser_cloud(scan, true);
  EXPECT_EQ(plain.points.size(), 2U);
  EXPECT_EQ(clear.points, plain.points);
  EXPECT_EQ(plain.infinite, 3U);
  EXPECT_EQ(plain.at_range, 2U);
  EXPECT_TRUE(plain.clear_to.empty());
  ASSERT_EQ(clear.clear_to.size(), 3U);
  for (const Eigen::Vector3f& end : clear.clear_to) EXPECT_NEAR(end.norm(), 8.1, 1e-5);
}

}  // namespace sensor_frames_test
}  // namespace clearway
