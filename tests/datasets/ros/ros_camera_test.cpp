#include "datasets/ros/ros_camera.hpp"

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <cmath>
#include <random>

namespace clearway {
namespace ros_camera_test {

RosCameraInfo info_of(const std::string& model, const std::vector<double>& d) {
  RosCameraInfo info;
  info.width = 64;
  info.height = 48;
  info.distortion_model = model;
  info.d = d;
  info.k = {20, 0, 31.5, 0, 21, 23.5, 0, 0, 1};
  return info;
}

CameraIntrinsics lens_of(const RosCameraInfo& info) { return raw_camera(info).intrinsics; }

std::string refusal_of(const RosCameraInfo& info, RosCamera (*camera)(const RosCameraInfo&) = raw_camera) {
  try {
    camera(info);
  } catch (const std::runtime_error& error) {
    return error.what();
  }
  return "";
}

TEST(RosCamera, CameraInfoNamesItsLens) {
  CameraIntrinsics expected{64, 48, 20, 21, 31.5, 23.5, {0.1, 0.2, 0.3, 0.4, 0.5, 0.6, 0.7, 0.8}};
  expected.lens = LensModel::rational;
  EXPECT_EQ(lens_of(info_of("rational_polynomial", {0.1, 0.2, 0.3, 0.4, 0.5, 0.6, 0.7, 0.8})), expected);
  EXPECT_EQ(lens_of(info_of("rational_polynomial",  // as of an OAK-D
                            {0.1, 0.2, 0.3, 0.4, 0.5, 0.6, 0.7, 0.8, 0, 0, 0, 0, 0, 0})),
            expected);
  expected.lens = LensModel::fisheye;
  expected.distortion = {0.1, 0.2, 0.3, 0.4};
  for (const char* name : {"equidistant", "fisheye"}) {
    EXPECT_EQ(lens_of(info_of(name, {0.1, 0.2, 0.3, 0.4})), expected);
    EXPECT_EQ(lens_of(info_of(name, {0.1, 0.2, 0.3, 0.4, 0})), expected);  // as of a T265
  }
  expected.distortion = {};
  EXPECT_EQ(lens_of(info_of("equidistant", {0, 0, 0, 0})), expected);
  expected.lens = LensModel::plumb_bob;
  EXPECT_EQ(lens_of(info_of("", {})), expected);
  expected.distortion = {0.1, 0.2, 0.3, 0.4, 0.5};
  EXPECT_EQ(lens_of(info_of("plumb_bob", {0.1, 0.2, 0.3, 0.4, 0.5})), expected);
  EXPECT_EQ(lens_of(info_of("rational_polynomial", {0.1, 0.2, 0.3, 0.4, 0.5, 0, 0, 0})), expected);
}

/// In the words of librealsense (rs2_distortion_to_string), as its own bags have them.
TEST(RosCamera, TheLensesOfRealsensesBagsAreKnown) {
  CameraIntrinsics expected{64, 48, 20, 21, 31.5, 23.5, {0.1, 0.2, 0.3, 0.4, 0.5}};
  EXPECT_EQ(lens_of(info_of("Brown Conrady", {0.1, 0.2, 0.3, 0.4, 0.5})), expected);
  expected.distortion = {};
  for (const char* name : {"Inverse Brown Conrady", "Modified Brown Conrady", "None"})
    EXPECT_EQ(lens_of(info_of(name, {0, 0, 0, 0, 0})), expected) << name;
  expected.lens = LensModel::fisheye;
  expected.distortion = {0.1, 0.2, 0.3, 0.4};
  EXPECT_EQ(lens_of(info_of("Kannala Brandt4", {0.1, 0.2, 0.3, 0.4, 0})), expected);
  const std::string inverse = refusal_of(info_of("Inverse Brown Conrady", {0.1, 0, 0, 0, 0}));
  EXPECT_NE(inverse.find("'Inverse Brown Conrady' is none of OpenCV's"), std::string::npos) << inverse;
}

TEST(RosCamera, OtherLensesAreRefusedWithThoseThatAreKnown) {
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

TEST(RosCamera, ARectifiedTopicIsKnownByItsName) {
  for (const char* name : {"image_rect", "/camera/image_rect", "/camera/image_rect_color",
                           "/a/image_rect_raw", "/depth_registered/image_rect",
                           "/camera/image_rect/compressed", "/camera/depth/image_rect_raw/compressedDepth"})
    EXPECT_TRUE(is_named_rectified(name)) << name;
  for (const char* name : {"/camera/image_raw", "/aligned_depth_to_color/image_raw", "/image_rect/image_raw",
                           "/camera/image", "/camera/image_color/compressed", "/rect", "/my_image_rect", ""})
    EXPECT_FALSE(is_named_rectified(name)) << name;
}

TEST(RosCamera, ARectifiedImageFollowsPAndHasNoDistortion) {
  RosCameraInfo info = info_of("plumb_bob", {0.1, 0.2, 0.3, 0.4, 0.5});
  info.p = {18, 0, 30.5, -4, 0, 19, 22.5, 0, 0, 0, 1, 0};
  info.r = {0.8, 0, 0.6, 0, 1, 0, -0.6, 0, 0.8};
  CameraIntrinsics expected{64, 48, 18, 19, 30.5, 22.5, {}};
  expected.is_rectified = true;
  EXPECT_EQ(rectified_camera(info).intrinsics, expected);
  EXPECT_TRUE(rectified_camera(info).frame_from_camera.isIdentity()) << "R leads to its axes";
  const RosCamera raw = raw_camera(info);
  EXPECT_EQ(raw.intrinsics, (CameraIntrinsics{64, 48, 20, 21, 31.5, 23.5, {0.1, 0.2, 0.3, 0.4, 0.5}}));
  EXPECT_EQ(raw.frame_from_camera * Eigen::Vector3d(0, 0, 1), Eigen::Vector3d(0.6, 0, 0.8));
  info.distortion_model = "omni";  // of the raw lens: nobody asks for it
  EXPECT_EQ(rectified_camera(info).intrinsics, expected);
}

TEST(RosCamera, BinningAndRegionOfInterestAreThoseOfImageGeometry) {
  RosCameraInfo info = info_of("plumb_bob", {0.1, 0.2, 0.3, 0.4, 0.5});
  info.p = {18, 0, 30.5, 0, 0, 19, 22.5, 0, 0, 0, 1, 0};
  info.binning_x = 2;
  EXPECT_EQ(raw_camera(info).intrinsics,
            (CameraIntrinsics{32, 48, 10, 21, 15.75, 23.5, {0.1, 0.2, 0.3, 0.4, 0.5}}));
  info.binning_y = 3;
  info.roi_x = 4;
  info.roi_y = 6;
  info.roi_width = 40;
  info.roi_height = 36;
  EXPECT_EQ(raw_camera(info).intrinsics,
            (CameraIntrinsics{20, 12, 10, 7, 13.75, 17.5 / 3, {0.1, 0.2, 0.3, 0.4, 0.5}}));
  CameraIntrinsics rectified{20, 12, 9, 19.0 / 3, 13.25, 5.5, {}};
  rectified.is_rectified = true;
  EXPECT_EQ(rectified_camera(info).intrinsics, rectified);
  info.roi_width = 61;
  EXPECT_EQ(refusal_of(info), "its region of interest lies beyond its sensor");
  info.roi_width = 1;
  EXPECT_EQ(refusal_of(info), "its binning leaves no pixel of its image");
}

TEST(RosCamera, WithoutPARectifiedImageFollowsKOnlyWhereNothingWasRectified) {
  CameraIntrinsics expected{64, 48, 20, 21, 31.5, 23.5, {}};
  expected.is_rectified = true;
  RosCameraInfo info = info_of("plumb_bob", {0, 0, 0, 0, 0});
  EXPECT_EQ(rectified_camera(info).intrinsics, expected);
  const std::string refusal = "its P is all 0, so that nothing says what its rectified images follow";
  info.r = {0.8, 0, 0.6, 0, 1, 0, -0.6, 0, 0.8};
  EXPECT_TRUE(refusal_of(info, rectified_camera).starts_with(refusal)) << "it was turned";
  for (const RosCameraInfo& lens :
       {info_of("plumb_bob", {0.1}), info_of("equidistant", {0, 0, 0, 0}), info_of("omni", {0.1})})
    EXPECT_TRUE(refusal_of(lens, rectified_camera).starts_with(refusal)) << lens.distortion_model;
}

TEST(RosCamera, ARegionOfInterestMustBeWhole) {
  RosCameraInfo info = info_of("plumb_bob", {0.1, 0.2, 0.3, 0.4, 0.5});
  info.p = {18, 0, 30.5, 0, 0, 19, 22.5, 0, 0, 0, 1, 0};
  info.roi_x = 4;
  EXPECT_EQ(refusal_of(info),
            "its region of interest begins at 4, 0 and has 0 x 0 pixels, expected all of them 0, or a size");
  info.roi_width = 40;
  info.roi_height = 36;
  EXPECT_EQ(refusal_of(info, rectified_camera), "");
  info.do_rectify = true;
  EXPECT_EQ(refusal_of(info), "") << "raw images are the window itself";
  EXPECT_TRUE(refusal_of(info, rectified_camera).starts_with("its region of interest has do_rectify"));
  info.roi_x = 0;
  info.roi_width = 64;
  info.roi_height = 48;
  EXPECT_EQ(refusal_of(info, rectified_camera), "") << "all of the image";
}

TEST(RosCamera, ARoundedRIsTakenForTheNearestRotation) {
  std::mt19937 random(5);
  std::uniform_real_distribution<double> unit(-1, 1);
  double farthest = 0, skew = 0;
  for (int i = 0; i < 1000; ++i) {
    const Eigen::Matrix3d truth =
        Eigen::AngleAxisd(0.3 * unit(random),
                          Eigen::Vector3d(unit(random), unit(random), unit(random)).normalized())
            .toRotationMatrix();
    RosCameraInfo info = info_of("plumb_bob", {});
    for (int k = 0; k < 9; ++k)
      info.r[static_cast<std::size_t>(k)] = std::round(1e4 * truth(k / 3, k % 3)) / 1e4;
    const Eigen::Matrix3d turn = raw_camera(info).frame_from_camera;
    farthest = std::max(farthest, (turn - truth).norm());
    skew = std::max(skew, (turn * turn.transpose() - Eigen::Matrix3d::Identity()).norm());
  }
  EXPECT_LT(farthest, 2e-4);
  EXPECT_LT(skew, 1e-14);
  RosCameraInfo coarse = info_of("plumb_bob", {});
  coarse.r = {0.9998, 0.0198, 0, -0.0198, 0.9998, 0, 0, 0, 0.9995};  // three decimals in places
  EXPECT_EQ(refusal_of(coarse), "its R is not a rotation, even if its numbers were rounded to four decimals");
  coarse.r = {1, 0, 0, 0, 1, 0, 0, 0, -1};
  EXPECT_NE(refusal_of(coarse), "") << "a mirror";
}

TEST(RosCamera, MatricesThatAreNoneAreRefused) {
  RosCameraInfo info = info_of("plumb_bob", {});
  info.r = {2, 0, 0, 0, 1, 0, 0, 0, 1};
  EXPECT_TRUE(refusal_of(info).starts_with("its R is not a rotation"));
  info.p = {18, 1, 30.5, 0, 0, 19, 22.5, 0, 0, 0, 1, 0};
  EXPECT_TRUE(refusal_of(info, rectified_camera).starts_with("its P is not a projection")) << "skewed";
  info.p = {0, 0, 30.5, 0, 0, 19, 22.5, 0, 0, 0, 1, 0};
  EXPECT_TRUE(refusal_of(info, rectified_camera).starts_with("its P is not a projection"));
  const std::array<double, 9> sound = info.k;
  info.r = {1, 0, 0, 0, 1, 0, 0, 0, 1};
  for (const std::size_t i : {1U, 3U, 6U, 7U, 8U}) {
    info.k = sound;
    info.k[i] += 0.5;
    EXPECT_TRUE(refusal_of(info).starts_with("its K is no camera matrix")) << i;
  }
  info.k = {sound[0], 0, 0, 0, sound[4], 0, sound[2], sound[5], 1};
  EXPECT_TRUE(refusal_of(info).starts_with("its K is no camera matrix")) << "column by column";
  info.k = sound;
  EXPECT_EQ(refusal_of(info), "");
  info.k[0] = std::nan("");
  EXPECT_EQ(refusal_of(info), "it is not calibrated");
}

}  // namespace ros_camera_test
}  // namespace clearway
