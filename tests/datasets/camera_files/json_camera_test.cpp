// Cameras whose coefficients or lens stand beside their numbers, as other people's JSON has them.
#include <gtest/gtest.h>

#include "datasets/camera_files/camera_file.hpp"
#include "datasets/sources/lens.hpp"
#include "tests/datasets/complaint.hpp"

namespace clearway {
namespace json_camera_test {

const std::string numbers =
    R"("fx": 691.3, "fy": 691.4, "cx": 640.9, "cy": 363.9, "width": 1280, "height": 720)";
const std::string other =
    R"("fx": 475.1, "fy": 475.2, "cx": 317.3, "cy": 196.7, "width": 640, "height": 400)";

CameraIntrinsics with_lens(LensModel model, const std::vector<double>& coefficients) {
  CameraIntrinsics camera{1280, 720, 691.3, 691.4, 640.9, 363.9, {}};
  set_lens(camera, model, coefficients);
  return camera;
}

CameraIntrinsics camera_of(const std::string& text, const std::string& name = "",
                           std::optional<LensModel> lens = {}, std::string* note = nullptr) {
  return parse_camera_file(text, "c.json", name, false, {}, lens, note);
}

std::string refusal_of(const std::string& text, const std::string& name = "") {
  return complaint([&] { camera_of(text, name); });
}

TEST(JsonCamera, CoefficientsBesideItsNumbersAreItsOwn) {
  const CameraIntrinsics bent = with_lens(LensModel::plumb_bob, {0.08, -0.11, 0.001, -0.002, 0.04});
  const std::string named = R"({"k1": 0.08, "k2": -0.11, "p1": 0.001, "p2": -0.002, "k3": 0.04})";
  const std::string listed = "[0.08, -0.11, 0.001, -0.002, 0.04]";
  for (const std::string& coefficients : {named, listed}) {
    EXPECT_EQ(camera_of("{\"intrinsics\": {" + numbers + "}, \"distortion\": " + coefficients + "}"), bent);
    EXPECT_EQ(camera_of("{\"camera\": {" + numbers + "}, \"dist_coeffs\": " + coefficients + "}"), bent);
    EXPECT_EQ(
        camera_of("{\"camera\": {\"intrinsics\": {" + numbers + "}}, \"distortion\": " + coefficients + "}"),
        bent);
    EXPECT_EQ(camera_of("{\"camera\": {" + numbers + ", \"distortion\": " + coefficients + "}}"), bent);
  }
}

TEST(JsonCamera, OfTwoCamerasEachHasTheCoefficientsOfItsName) {
  const std::string orbbec =
      "{\"depthIntrinsic\": {" + other + "}, \"rgbIntrinsic\": {" + numbers +
      R"(}, "depthDistortion": {"k1": 0, "k2": 0, "k3": 0, "k4": 0, "k5": 0, "k6": 0, "p1": 0, "p2": 0},
      "rgbDistortion": {"k1": 0.08, "k2": -0.11, "k3": 0.04, "k4": 0.3, "k5": 0.2, "k6": 0.1, "p1": 0, "p2": 0}})";
  EXPECT_EQ(camera_of(orbbec, "rgbIntrinsic"),
            with_lens(LensModel::rational, {0.08, -0.11, 0, 0, 0.04, 0.3, 0.2, 0.1}));
  EXPECT_EQ(camera_of(orbbec, "depthIntrinsic"),
            (CameraIntrinsics{640, 400, 475.1, 475.2, 317.3, 196.7, {}}));
}

TEST(JsonCamera, CoefficientsOfAnUnsureCameraAreRefused) {
  const std::string both = "{\"left\": {" + numbers + "}, \"right\": {" + other + "}, ";
  EXPECT_NE(refusal_of(both + R"("distortion": [0.1, 0, 0, 0]})", "left").find("'left_distortion'"),
            std::string::npos);
  EXPECT_EQ(camera_of(both + R"("distortion": [0, 0, 0, 0]})", "left"), with_lens(LensModel::plumb_bob, {}));
  EXPECT_NE(refusal_of("{\"all\": " + both.substr(0, both.size() - 2) + R"(}, "distortion": [0.1, 0, 0, 0]})",
                       "all.left")
                .find("'all_distortion'"),
            std::string::npos);
  EXPECT_NE(refusal_of("{\"color\": {" + numbers + R"(}, "rgbDistortion": {"k1": 0.1}})")
                .find("'color_distortion'"),
            std::string::npos);
  EXPECT_NE(refusal_of("{\"camera\": {" + numbers +
                       R"(}, "distortion": [0.1, 0, 0, 0], "dist_coeffs": [0, 0, 0, 0]})")
                .find("once"),
            std::string::npos);
  for (const char* twice :
       {R"("k1": 0.2}, "distortion": {"k1": 0.1}})", R"("k1": 0.2, "distortion": [0.1, 0, 0, 0]}})"})
    EXPECT_NE(refusal_of("{\"camera\": {" + numbers + ", " + twice).find("once, got them twice"),
              std::string::npos);
}

TEST(JsonCamera, WhatIsBesideItAndNoCoefficientsIsNotTakenForThem) {
  const CameraIntrinsics flat = with_lens(LensModel::plumb_bob, {});
  EXPECT_EQ(camera_of("{\"distorted\": {" + other + ", \"k1\": 0.1}, \"undistorted\": {" + numbers + "}}",
                      "undistorted"),
            flat);
  for (const char* beside :
       {R"("undistort_roi": [0, 0, 1280, 720])", R"("lensDistortionCenter": [640, 360])",
        R"("distortion": {})", R"("distortion": {"model": "none", "coefficients": []})",
        R"("distortion": null)", R"("model": "Azure Kinect NFOV")", R"("distance": [1, 2])"})
    EXPECT_EQ(camera_of("{\"intrinsics\": {" + numbers + "}, " + beside + "}"), flat) << beside;
}

TEST(JsonCamera, OfSeveralCamerasCoefficientsMayStandByTheirNames) {
  const std::string text = "{\"camera\": {\"left\": {" + numbers + "}, \"right\": {" + other +
                           "}}, \"distortion\": {\"left\": [0.3, -0.2, 0, 0, 0], \"right\": {\"k1\": 0.1}}}";
  EXPECT_EQ(camera_of(text, "camera.left"), with_lens(LensModel::plumb_bob, {0.3, -0.2}));
  EXPECT_EQ(camera_of(text, "camera.right").distortion[0], 0.1);
}

TEST(JsonCamera, TheLensThatItsHolderNamesIsItsOwn) {
  const std::string inside = "\"intrinsics\": {" + numbers + "}, ";
  const CameraIntrinsics fisheye = with_lens(LensModel::fisheye, {-0.1, 0.02, 0.003, 0.004});
  EXPECT_EQ(camera_of("{\"camera_model\": \"fisheye\", " + inside +
                      R"("distortion": {"k1": -0.1, "k2": 0.02, "k3": 0.003, "k4": 0.004}})"),
            fisheye);
  EXPECT_EQ(camera_of("{" + inside + R"("distortion": {"k1": -0.1, "k2": 0.02, "k3": 0.003, "k4": 0.004}})",
                      "", LensModel::fisheye),
            fisheye);
  EXPECT_NE(
      refusal_of("{\"camera_model\": \"fisheye\", " + inside + R"("distortion": {"k1": -0.1, "p1": 0.001}})"),
      "");
  EXPECT_NE(refusal_of("{" + inside + R"("distortion": {"k1": -0.1, "k4": 0.004}})").find("`lens: fisheye`"),
            std::string::npos);
  EXPECT_NE(refusal_of("{\"camera_model\": \"omni\", " + inside + R"("distortion": [0.1, 0, 0, 0]})")
                .find("'omni'"),
            std::string::npos);
  EXPECT_NE(
      complaint([&] { camera_of("{" + numbers + "}", "", LensModel::fisheye); }).find("no coefficients"),
      std::string::npos);
  for (const char* lens : {"equisolid", "equirectangular", "fisheye_stereographic"})
    EXPECT_NE(refusal_of("{" + numbers + ", \"camera_model\": \"" + lens + "\", \"k1\": 0.1}").find(lens),
              std::string::npos);
}

TEST(JsonCamera, CoefficientsThatCannotBeReadAreRefused) {
  for (const char* more :
       {R"("radial": [0.1, 0.02])", R"("tangential": [0.001, 0.0])",
        R"("distortion": {"radial": [0.1, 0.02]})", R"("distortionModel": "KB4", "params": [0.1])"}) {
    EXPECT_NE(refusal_of("{" + numbers + ", " + more + "}"), "") << more;
    EXPECT_NE(refusal_of("{\"camera\": {" + numbers + ", " + more + "}}"), "") << more;
  }
  EXPECT_NE(refusal_of("{\"camera\": {" + numbers + R"(}, "distortion": {"radial": [0.1, 0.02]}})"), "");
  EXPECT_EQ(camera_of(R"({"camera_type": "kb4", "intrinsics": {"k1": 0.1, "k2": 0.02, "k3": 0, "k4": 0, )" +
                      numbers + "}}"),
            with_lens(LensModel::fisheye, {0.1, 0.02, 0, 0}));
}

TEST(JsonCamera, FourCoefficientsOfNoNamedLensAreNoted) {
  std::string note;
  camera_of("{\"camera\": {" + numbers + R"(}, "distortion": [0.1, 0.02, 0, 0]})", "", {}, &note);
  EXPECT_NE(note.find("`lens: fisheye`"), std::string::npos);
}

}  // namespace json_camera_test
}  // namespace clearway
