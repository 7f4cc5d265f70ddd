// Settings of ORB-SLAM and of OpenVSLAM (stella_vslam), which name the lens and the size otherwise.
#include <gtest/gtest.h>

#include "datasets/camera_files/camera_file.hpp"
#include "datasets/sources/lens.hpp"
#include "tests/datasets/complaint.hpp"

namespace clearway {
namespace slam_camera_test {

const std::string flat = "Camera.fx: 717.2\nCamera.fy: 717.4\nCamera.cx: 729.2\nCamera.cy: 552.5\n";
const std::string four = "Camera.k1: -0.16\nCamera.k2: 0.06\nCamera.k3: -0.075\nCamera.k4: 0.034\n";
const std::string size = "Camera.cols: 1440\nCamera.rows: 1080\n";

CameraIntrinsics with_lens(LensModel model, const std::vector<double>& coefficients) {
  CameraIntrinsics camera{1440, 1080, 717.2, 717.4, 729.2, 552.5, {}};
  set_lens(camera, model, coefficients);
  return camera;
}

CameraIntrinsics camera_of(const std::string& text, std::optional<LensModel> lens = {},
                           bool is_rectified = false) {
  return parse_camera_file(text, "c.yaml", "", is_rectified, {}, lens);
}

std::string refusal_of(const std::string& text) {
  return complaint([&] { camera_of(text); });
}

TEST(SlamCamera, FourCoefficientsNeedAFisheyeThatIsNamed) {
  const CameraIntrinsics fisheye = with_lens(LensModel::fisheye, {-0.16, 0.06, -0.075, 0.034});
  EXPECT_NE(refusal_of(flat + four + size).find("`lens: fisheye`"), std::string::npos);
  EXPECT_EQ(camera_of(flat + four + size, LensModel::fisheye), fisheye);
  EXPECT_EQ(camera_of(flat + four + size + "Camera.model: fisheye\n"), fisheye);
  EXPECT_EQ(camera_of(flat + four + size + "Camera.type: KannalaBrandt8\n"), fisheye);
  EXPECT_EQ(camera_of(flat + four + size + "Camera.FishEye: 1\n"), fisheye);
  EXPECT_NE(refusal_of(flat + four + size + "Camera.type: PinHole\n").find("Camera.k4: expected a plumb_bob"),
            std::string::npos);
  EXPECT_NE(refusal_of(flat + four + size + "Camera.model: radial_division\n").find("Camera.model"),
            std::string::npos);
  EXPECT_NE(complaint([&] { camera_of(flat + size, LensModel::fisheye); }).find("no coefficients"),
            std::string::npos);
}

TEST(SlamCamera, WhatSaysNoSizeNamesTheCure) {
  EXPECT_NE(refusal_of(flat).find("`width` and `height` beside `file`"), std::string::npos);
}

TEST(SlamCamera, APerspectiveCameraOfOpenvslamIsAPlumbBob) {
  EXPECT_EQ(camera_of(flat + size +
                      "Camera.model: perspective\nCamera.k1: 0.1\nCamera.p2: 0.002\nCamera.k3: 0.03\n"),
            with_lens(LensModel::plumb_bob, {0.1, 0, 0, 0.002, 0.03}));
}

TEST(SlamCamera, SixRadialCoefficientsAreARationalLens) {
  const std::string azure =
      "Camera.k1: 0.5\nCamera.k2: -2.6\nCamera.k3: 1.5\nCamera.k4: 0.4\nCamera.k5: -2.4\n"
      "Camera.k6: 1.4\n";
  for (const char* type : {"", "Camera.type: PinHole\n", "Camera.model: RealSense D435i\n"})
    EXPECT_EQ(camera_of(flat + size + azure + type),
              with_lens(LensModel::rational, {0.5, -2.6, 0, 0, 1.5, 0.4, -2.4, 1.4}));
}

TEST(SlamCamera, OfRectifiedPicturesNoLensIsNeeded) {
  EXPECT_EQ(camera_of(flat + size, LensModel::fisheye, true).fx, 717.2);
}

TEST(SlamCamera, StellasNestedSettingsAreRead) {
  const std::string nested =
      "Camera:\n  model: fisheye\n  fx: 717.2\n  fy: 717.4\n  cx: 729.2\n  cy: 552.5\n  k1: -0.16\n  k2: "
      "0.06\n"
      "  k3: -0.075\n  k4: 0.034\n  cols: 1440\n  rows: 1080\n";
  EXPECT_EQ(camera_of(nested), with_lens(LensModel::fisheye, {-0.16, 0.06, -0.075, 0.034}));
}

TEST(SlamCamera, StellasRectifiedCameraIsNotTakenForTheRawOne) {
  const std::string nested =
      "Camera:\n  model: perspective\n  fx: 717.2\n  fy: 717.4\n  cx: 729.2\n  cy: 552.5\n  cols: 1440\n"
      "  rows: 1080\nStereoRectifier:\n  K_left: [458.6, 0, 367.2, 0, 457.2, 248.3, 0, 0, 1]\n";
  EXPECT_NE(refusal_of(nested).find("rectified: true"), std::string::npos);
  EXPECT_NE(refusal_of(flat + size + "StereoRectifier.K_left: [458.6, 0, 367.2, 0, 457.2, 248.3, 0, 0, 1]\n"),
            "");
  EXPECT_EQ(camera_of(nested, {}, true).fx, 717.2);
}

}  // namespace slam_camera_test
}  // namespace clearway
