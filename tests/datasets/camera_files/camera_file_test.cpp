#include "datasets/camera_files/camera_file.hpp"

#include <gtest/gtest.h>

#include "datasets/descriptions/setup.hpp"
#include "tests/datasets/complaint.hpp"
#include "tests/worlds/temporary_folder.hpp"

namespace clearway {
namespace camera_file_test {

const std::string kalibr = R"(cam0:
  cam_overlaps: []
  camera_model: pinhole
  distortion_coeffs: [-0.28, 0.07, 0.0001, -0.0002]
  distortion_model: radtan
  intrinsics: [458.6, 457.2, 367.2, 248.3]
  resolution: [752, 480]
  rostopic: /cam0/image_raw
)";
const std::string ros = R"(image_width: 752
image_height: 480
camera_name: narrow_stereo
camera_matrix:
  rows: 3
  cols: 3
  data: [458.6, 0, 367.2, 0, 457.2, 248.3, 0, 0, 1]
distortion_model: plumb_bob
distortion_coefficients:
  rows: 1
  cols: 5
  data: [-0.28, 0.07, 0.0001, -0.0002, 0]
rectification_matrix: {rows: 3, cols: 3, data: [1, 0, 0, 0, 1, 0, 0, 0, 1]}
projection_matrix: {rows: 3, cols: 4, data: [400, 0, 360, 0, 0, 400, 240, 0, 0, 0, 1, 0]}
)";

std::string with(std::string text, const std::string& old, const std::string& by) {
  return text.replace(text.find(old), old.size(), by);
}

std::string refusal_of(const std::string& text, const std::string& camera = "") {
  try {
    parse_camera_file(text, "c.yaml", camera);
  } catch (const std::invalid_argument& error) {
    return error.what();
  }
  return "";
}

TEST(CameraFile, kalibr_and_ros_describe_the_same_camera) {
  const CameraIntrinsics expected{752, 480, 458.6, 457.2, 367.2, 248.3, {-0.28, 0.07, 0.0001, -0.0002, 0}};
  EXPECT_EQ(parse_camera_file(kalibr, "c.yaml", ""), expected);
  EXPECT_EQ(parse_camera_file(kalibr, "c.yaml", "cam0"), expected);
  EXPECT_EQ(parse_camera_file(ros, "c.yaml", ""), expected);
  const std::string rational =
      with(with(ros, "plumb_bob", "rational_polynomial"), "-0.0002, 0]", "-0.0002, 0, 0, 0, 0]");
  EXPECT_EQ(parse_camera_file(rational, "c.yaml", ""), expected);
}

TEST(CameraFile, rational_and_fisheye_lenses_keep_their_coefficients) {
  CameraIntrinsics expected{752, 480, 458.6, 457.2, 367.2, 248.3, {-0.28, 0.07, 0.0001, -0.0002}};
  expected.lens = LensModel::fisheye;
  EXPECT_EQ(parse_camera_file(with(kalibr, "radtan", "equidistant"), "c.yaml", ""), expected);
  for (const std::string name : {"equidistant", "fisheye"})
    EXPECT_EQ(parse_camera_file(with(with(ros, "plumb_bob", name), "-0.0002, 0]", "-0.0002]"), "c.yaml", ""),
              expected);
  expected.lens = LensModel::rational;
  expected.distortion = {-0.28, 0.07, 0.0001, -0.0002, 0.5, 0.1, 0.2, 0.3};
  const std::string rational = with(ros, "plumb_bob", "rational_polynomial");
  for (const std::string rest : {"", ", 0, 0, 0, 0", ", 0, 0, 0, 0, 0, 0"})  // of thin prisms and tilts
    EXPECT_EQ(parse_camera_file(with(rational, "-0.0002, 0]", "-0.0002, 0.5, 0.1, 0.2, 0.3" + rest + "]"),
                                "c.yaml", ""),
              expected);
}

TEST(CameraFile, a_setup_takes_it_relative_to_its_own_folder) {
  const TemporaryFolder folder;
  folder.write("ros.yaml", ros);
  folder.write("setup.yaml", "camera: {file: ros.yaml}\n");
  EXPECT_EQ(load_setup(folder.file("setup.yaml")).camera, parse_camera_file(ros, "", ""));
}

TEST(CameraFile, rectified_pictures_follow_the_projection_matrix) {
  CameraIntrinsics expected{752, 480, 400, 400, 360, 240, {}};
  expected.is_rectified = true;
  EXPECT_EQ(parse_camera_file(ros, "c.yaml", "", true), expected);
  const std::string bare = with(ros, ros.substr(ros.find("projection_matrix")), "");
  const auto refusal = [](const std::string& text) {
    return complaint([&] { parse_camera_file(text, "c.yaml", "", true); });
  };
  EXPECT_NE(refusal(bare).find("its P is all 0"), std::string::npos) << refusal(bare);
  EXPECT_NE(refusal(kalibr).find("expected ROS's camera_info with a projection_matrix"), std::string::npos);
  // Where nothing was to be rectified, K will do.
  CameraIntrinsics pinhole{752, 480, 458.6, 457.2, 367.2, 248.3, {}};
  pinhole.is_rectified = true;
  EXPECT_EQ(
      parse_camera_file(with(bare, "-0.28, 0.07, 0.0001, -0.0002, 0]", "0, 0, 0, 0, 0]"), "c.yaml", "", true),
      pinhole);
  EXPECT_EQ(
      parse_camera_file(with(kalibr, "-0.28, 0.07, 0.0001, -0.0002]", "0, 0, 0, 0]"), "c.yaml", "", true),
      pinhole);
}

TEST(CameraFile, opencv_names_its_lens_by_the_number_of_its_coefficients) {
  const auto file = [](const std::string& coefficients, const std::string& more = "") {
    return "%YAML:1.0\n---\ncalibration_time: \"Thu Jan  1 00:00:00 2026\"\nimage_width: 752\nimage_height: "
           "480\n" +
           more +
           "camera_matrix: !!opencv-matrix\n   rows: 3\n   cols: 3\n   dt: d\n"
           "   data: [ 4.586e+02, 0., 367.2, 0., 457.2, 248.3, 0., 0., 1. ]\n"
           "distortion_coefficients: !!opencv-matrix\n   rows: 5\n   cols: 1\n   dt: d\n   data: [ " +
           coefficients + " ]\n";
  };
  CameraIntrinsics expected{752, 480, 458.6, 457.2, 367.2, 248.3, {-0.28, 0.07, 0.0001, -0.0002, 0.01}};
  EXPECT_EQ(parse_camera_file(file("-0.28, 7.0e-02, 0.0001, -0.0002, 0.01"), "c.yml", ""), expected);
  expected.distortion = {-0.28, 0.07, 0.0001, -0.0002, 0.01, 0.1, 0.2, 0.3};
  expected.lens = LensModel::rational;
  EXPECT_EQ(parse_camera_file(file("-0.28, 7.0e-02, 0.0001, -0.0002, 0.01, 0.1, 0.2, 0.3"), "c.yml", ""),
            expected);
  expected.distortion = {-0.28, 0.07, 0.0001, -0.0002};
  expected.lens = LensModel::fisheye;
  EXPECT_EQ(parse_camera_file(file("-0.28, 0.07, 0.0001, -0.0002", "fisheye_model: 1\n"), "c.yml", ""),
            expected);
}

TEST(CameraFile, an_echo_of_a_camera_info_message_is_read_as_the_message_is) {
  const std::string ros2 =
      "header:\n  stamp: {sec: 7, nanosec: 9}\n  frame_id: optical\nheight: 480\nwidth: 752\n"
      "distortion_model: plumb_bob\nd:\n- -0.28\n- 0.07\n- 0.0001\n- -0.0002\n- 0.0\n"
      "k: [458.6, 0, 367.2, 0, 457.2, 248.3, 0, 0, 1]\nr: [1, 0, 0, 0, 1, 0, 0, 0, 1]\n"
      "p: [400, 0, 360, 0, 0, 400, 240, 0, 0, 0, 1, 0]\nbinning_x: 2\nbinning_y: 2\n"
      "roi: {x_offset: 0, y_offset: 0, height: 0, width: 0, do_rectify: false}\n---\n";
  const CameraIntrinsics raw{376, 240, 229.3, 228.6, 183.6, 124.15, {-0.28, 0.07, 0.0001, -0.0002, 0}};
  EXPECT_EQ(parse_camera_file(ros2, "c.yaml", ""), raw);
  std::string ros1 = ros2;
  for (const auto& [small, big] :
       {std::pair{"\nd:", "\nD:"}, {"\nk:", "\nK:"}, {"\nr:", "\nR:"}, {"\np:", "\nP:"}})
    ros1 = with(ros1, small, big);
  EXPECT_EQ(parse_camera_file(ros1, "c.yaml", ""), raw);
  CameraIntrinsics rectified{376, 240, 200, 200, 180, 120, {}};
  rectified.is_rectified = true;
  EXPECT_EQ(parse_camera_file(ros2, "c.yaml", "", true), rectified);
  EXPECT_NE(refusal_of(with(ros2, "plumb_bob", "omni")).find("'omni' is not known here"), std::string::npos);
}

TEST(CameraFile, coefficients_may_be_a_list_and_a_lens_without_any_is_refused) {
  const std::string map = "distortion_coefficients:\n  rows: 1\n  cols: 5\n  data: ";
  EXPECT_EQ(parse_camera_file(with(ros, map, "distortion_coefficients: "), "c.yaml", ""),
            parse_camera_file(ros, "c.yaml", ""));
  const std::string misspelt = refusal_of(with(ros, "distortion_coefficients", "distortion_coefficents"));
  EXPECT_NE(misspelt.find("expected those of its distortion_model"), std::string::npos) << misspelt;
}

TEST(CameraFile, a_setup_says_which_pictures_are_rectified) {
  const TemporaryFolder folder;
  folder.write("ros.yaml", ros);
  const CameraIntrinsics raw = parse_camera_file(ros, "", ""),
                         rectified = parse_camera_file(ros, "", "", true);
  const auto setup = [&](const std::string& camera, const std::string& source) {
    folder.write("setup.yaml", "camera: {file: ros.yaml" + camera + "}\n" + source);
    return load_setup(folder.file("setup.yaml"));
  };
  EXPECT_EQ(setup("", "").camera, raw);
  EXPECT_EQ(setup(", rectified: true", "").camera, rectified);
  const auto bag = [&](const std::string& topics) { return setup("", "source: {bag: {" + topics + "}}\n"); };
  EXPECT_EQ(bag("images: /image_raw").camera, raw);
  EXPECT_EQ(bag("images: /image_rect").camera, rectified);
  EXPECT_EQ(bag("images: /image_rect, rectified: false").camera, raw);
  EXPECT_EQ(bag("images: /image_raw, rectified: true").camera, rectified);
  EXPECT_EQ(bag("depth: /image_rect_raw").camera, rectified);
  EXPECT_FALSE(bag("images: /image_raw").source.depth.camera);
  const clearway::Setup both = bag("images: /image_raw, depth: /image_rect");
  EXPECT_EQ(both.camera, raw);
  EXPECT_EQ(both.source.depth.camera, rectified);
  const clearway::Setup own = setup("", "source: {depth: {rectified: true, camera: {file: ros.yaml}}}\n");
  EXPECT_EQ(own.camera, raw);
  EXPECT_EQ(own.source.depth.camera, rectified);
  EXPECT_EQ(setup("", "source: {depth: {rectified: true}}\n").source.depth.camera, rectified);
  EXPECT_EQ(setup("", "source: {depth: {camera: {file: ros.yaml}}}\n").source.depth.camera, raw);
}

TEST(CameraFile, other_lenses_and_damaged_files_are_refused_in_a_sentence) {
  for (const auto& [text, words] : std::vector<std::pair<std::string, std::string>>{
           {with(kalibr, "radtan", "fov"), "the lens 'fov' is not known, expected plumb_bob"},
           {with(kalibr, "model: pinhole", "model: omni"), "the camera model 'omni' is not known"},
           {with(kalibr, "[-0.28, 0.07, 0.0001, -0.0002]", "[-0.28]"), "expected 4, 5 or 8 numbers, got 1"},
           {with(with(kalibr, "radtan", "equidistant"), "[-0.28, 0.07, 0.0001, -0.0002]", "[]"),
            "expected 4 numbers, got 0"},
           {with(with(ros, "plumb_bob", "fisheye"), "-0.0002, 0]", "-0.0002, 0.1]"), "k1, k2, k3, k4"},
           {with(ros, "-0.0002, 0]", "-0.0002, 0, 0.1, 0, 0]"), "k1, k2, p1, p2, k3"},
           {with(ros, "[458.6, 0,", "[458.6, 3,"), "expected [fx, 0, cx"},
           {with(ros, "[458.6, 0, 367.2, 0, 457.2, 248.3, 0, 0, 1]",
                 "[458.6, 0, 0, 0, 457.3, 0, 367.2, 248.4, 1]"),
            "row by row"},
           {with(ros, "[458.6, 0,", "[.nan, 0,"), "c.yaml"},
           {with(kalibr, "[458.6, ", "["), "intrinsics"},
           {with(kalibr, "[752, 480]", "[752, 4]"), "resolution"},
           {kalibr + with(kalibr, "cam0:", "cam1:"), "it has 2 cameras"},
           {"title: a\n", "expected kalibr's camchain"}}) {
    const std::string sentence = refusal_of(text);
    EXPECT_NE(sentence.find(words), std::string::npos) << sentence;
    EXPECT_NE(sentence.find("c.yaml"), std::string::npos) << sentence;
  }
  EXPECT_EQ(refusal_of(kalibr + with(kalibr, "cam0:", "cam1:"), "cam1"), "");
  EXPECT_NE(refusal_of(kalibr, "cam7"), "");
}

TEST(CameraFile, OrbSlamsSettingsAreRead) {
  for (const std::string prefix : {"Camera.", "Camera1."}) {
    std::string text = "%YAML:1.0\n---\nFile.version: \"1.0\"\nCamera.type: \"PinHole\"\n";
    for (const char* value : {"fx: 517.3", "fy: 516.5", "cx: 318.6", "cy: 255.3", "k1: 0.26", "k2: -0.95",
                              "p1: -0.005", "p2: 0.0026", "k3: 1.16"})
      text += prefix + value + "\n";
    text += "Camera.width: 640\nCamera.height: 480\nCamera.fps: 30\n";
    const CameraIntrinsics camera = parse_camera_file(text, "f", "", false);
    EXPECT_EQ(camera,
              (CameraIntrinsics{640, 480, 517.3, 516.5, 318.6, 255.3, {0.26, -0.95, -0.005, 0.0026, 1.16}}));
    const CameraIntrinsics fisheye =
        parse_camera_file(with(text, "PinHole", "KannalaBrandt8"), "f", "", false);
    EXPECT_EQ(fisheye.lens, LensModel::fisheye);
    EXPECT_EQ(fisheye.distortion, (std::array<double, 8>{0.26, -0.95, 1.16, 0}));
    EXPECT_NE(complaint([&] {
                parse_camera_file(with(text, "PinHole", "Omni"), "f", "", false);
              }).find("expected PinHole, KannalaBrandt8 or Rectified, got 'Omni'"),
              std::string::npos);
  }
}

TEST(CameraFile, ANameIsThatOfACameraInTheFileOrRefused) {
  const auto orb = [](const std::string& prefix, const std::string& fx) {
    return prefix + "fx: " + fx + "\n" + prefix + "fy: 516.5\n" + prefix + "cx: 318.6\n" + prefix +
           "cy: 255.3\n";
  };
  const std::string stereo =
      orb("Camera1.", "600") + orb("Camera2.", "500") + "Camera.width: 640\nCamera.height: 480\n";
  EXPECT_EQ(parse_camera_file(stereo, "f", "").fx, 600.0);
  EXPECT_EQ(parse_camera_file(stereo, "f", "Camera1").fx, 600.0);
  EXPECT_EQ(parse_camera_file(stereo, "f", "Camera2").fx, 500.0);
  EXPECT_NE(complaint([&] { parse_camera_file(stereo, "f", "Camera3"); }).find("no camera 'Camera3'"),
            std::string::npos);
  const std::string matrix = "{rows: 3, cols: 3, dt: d, data: [600, 0, 320, 0, 602, 240, 0, 0, 1]}\n";
  const std::string left = "image_width: 640\nimage_height: 480\nM1: " + matrix + "D1: [0.1, 0, 0, 0]\n";
  EXPECT_EQ(parse_camera_file(left, "f", "M1").fx, 600.0);
  EXPECT_NE(
      complaint([&] { parse_camera_file(left, "f", "M2"); }).find("one camera, which is not called 'M2'"),
      std::string::npos);
  const std::string ros =
      "image_width: 640\nimage_height: 480\ncamera_name: narrow\ncamera_matrix: " + matrix;
  EXPECT_EQ(parse_camera_file(ros, "f", "narrow").fx, 600.0);
  const std::string json = R"({"fx": 600, "fy": 600, "cx": 320, "cy": 240, "width": 640, "height": 480})";
  EXPECT_NE(complaint([&] { parse_camera_file(json, "f", "wide"); }).find("not called 'wide'"),
            std::string::npos);
  EXPECT_NE(complaint([&] { parse_camera_file(ros, "f", "wide"); }).find("not called 'wide'"),
            std::string::npos);
  EXPECT_NE(complaint([&] {
              parse_camera_file("600 0 320\n0 602 240\n0 0 1\n", "f", "wide", false, ImageSize{640, 480});
            }).find("a matrix alone"),
            std::string::npos);
}

/// ORB-SLAM2's EuRoC.yaml, whose lists begin without a blank.
TEST(CameraFile, OfOrbSlams2StereoSettingsTheRawCamerasAreLeftAndRight) {
  const std::string text =
      "%YAML:1.0\nCamera.fx: 435.2\nCamera.fy: 435.2\nCamera.cx: 367.4\nCamera.cy: 252.2\n"
      "Camera.width: 752\nCamera.height: 480\nLEFT.height: 480\nLEFT.width: 752\n"
      "LEFT.D: !!opencv-matrix\n   rows: 1\n   cols: 5\n   dt: d\n   data:[-0.28, 0.07, 0.0002, 0.00002, "
      "0.0]\n"
      "LEFT.K: !!opencv-matrix\n   rows: 3\n   cols: 3\n   dt: d\n"
      "   data: [458.6, 0.0, 367.2, 0.0, 457.3, 248.4, 0.0, 0.0, 1.0]\n"
      "LEFT.P: !!opencv-matrix\n   rows: 3\n   cols: 4\n   dt: d\n"
      "   data:[435.2, 0, 367.4, 0, 0, 435.2, 252.2, 0, 0, 0, 1, 0]\n";
  EXPECT_EQ(parse_camera_file(text, "f", "LEFT"),
            (CameraIntrinsics{752, 480, 458.6, 457.3, 367.2, 248.4, {-0.28, 0.07, 0.0002, 0.00002, 0.0}}));
  EXPECT_EQ(parse_camera_file(text, "f", "LEFT", true).fx, 435.2);
  EXPECT_EQ(parse_camera_file(text, "f", "", true).fx, 435.2);
  EXPECT_NE(complaint([&] { parse_camera_file(text, "f", ""); }).find("`name: LEFT`"), std::string::npos);
  EXPECT_NE(complaint([&] { parse_camera_file(text, "f", "RIGHT", true); }).find("no camera 'RIGHT'"),
            std::string::npos);
}

/// As cv::FileStorage writes what cv::stereoRectify gave, and sizes as matrices.
TEST(CameraFile, MatricesOfOpencvBesideRAndPAreNoMessageOfRos) {
  const auto matrix = [](const char* size, const char* data) {
    return std::string(": !!opencv-matrix\n   ") + size + "\n   dt: d\n   data: [ " + data + " ]\n";
  };
  const std::string text = "%YAML:1.0\n---\nK" +
                           matrix("rows: 3\n   cols: 3", "600, 0, 320, 0, 602, 240, 0, 0, 1") + "D" +
                           matrix("rows: 1\n   cols: 4", "0.1, 0, 0, 0") + "R" +
                           matrix("rows: 3\n   cols: 3", "1, 0, 0, 0, 1, 0, 0, 0, 1") + "P" +
                           matrix("rows: 3\n   cols: 4", "560, 0, 322, 0, 0, 570, 236, 0, 0, 0, 1, 0") +
                           "image_size" + matrix("rows: 1\n   cols: 2", "640, 480");
  const CameraIntrinsics raw = parse_camera_file(text, "f", "");
  EXPECT_EQ(raw.fx, 600.0);
  EXPECT_EQ(raw.distortion[0], 0.1);
  EXPECT_EQ(raw.width, 640);
  const CameraIntrinsics rectified = parse_camera_file(text, "f", "", true);
  EXPECT_EQ(rectified.fx, 560.0);
  EXPECT_EQ(rectified.cy, 236.0);
  EXPECT_EQ(rectified.distortion[0], 0.0);
}

/// cv::stereoCalibrate's R leads from one camera to the other; R1 and P1 are of the first one's pictures.
TEST(CameraFile, OfTwoCamerasEachHasItsOwnRectification) {
  const std::string k = "{rows: 3, cols: 3, dt: d, data: [500, 0, 320, 0, 500, 240, 0, 0, 1]}\n",
                    turn = "{rows: 3, cols: 3, dt: d, data: [0, -1, 0, 1, 0, 0, 0, 0, 1]}\n",
                    none = "{rows: 3, cols: 3, dt: d, data: [1, 0, 0, 0, 1, 0, 0, 0, 1]}\n";
  const auto p = [](const char* fx) {
    return "{rows: 3, cols: 4, dt: d, data: [" + std::string(fx) +
           ", 0, 322, 0, 0, 450, 240, 0, 0, 0, 1, 0]}\n";
  };
  const std::string text = "image_width: 640\nimage_height: 480\nK1: " + k + "K2: " + k +
                           "D1: [0, 0, 0, 0]\nD2: [0, 0, 0, 0]\nR: " + turn + "R1: " + none + "R2: " + none +
                           "P1: " + p("450") + "P2: " + p("460");
  EXPECT_EQ(parse_camera_file(text, "f", "K1", true).fx, 450.0);
  EXPECT_EQ(parse_camera_file(text, "f", "K2", true).fx, 460.0);
  EXPECT_EQ(parse_camera_file(text, "f", "K2").fx, 500.0);
}

}  // namespace camera_file_test
}  // namespace clearway
