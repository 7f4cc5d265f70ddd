// Camera files of other programs: OpenCV's are written by OpenCV, lenses compared with librealsense's
// formulas.
#include <gtest/gtest.h>

#include <opencv2/core.hpp>

#include "datasets/camera_files/camera_file.hpp"
#include "datasets/descriptions/setup.hpp"
#include "datasets/sources/lens.hpp"
#include "tests/datasets/complaint.hpp"
#include "tests/worlds/temporary_folder.hpp"

namespace clearway {
namespace foreign_cameras_test {

const CameraIntrinsics bent{752, 480, 458.6, 457.2, 367.2, 248.3, {-0.28, 0.07, 0.0001, -0.0002, 0.01}};
const cv::Mat matrix_of_bent = (cv::Mat_<double>(3, 3) << 458.6, 0, 367.2, 0, 457.2, 248.3, 0, 0, 1);
const cv::Mat lens_of_bent = (cv::Mat_<double>(1, 5) << -0.28, 0.07, 0.0001, -0.0002, 0.01);

std::string refusal_of(const std::string& text, const std::string& camera = "",
                       std::optional<ImageSize> size = {}) {
  return complaint([&] { parse_camera_file(text, "c.file", camera, false, size); });
}

std::string written_by_opencv(const std::string& kind, const std::function<void(cv::FileStorage&)>& fill) {
  cv::FileStorage file("c" + kind, cv::FileStorage::WRITE | cv::FileStorage::MEMORY);
  file << "calibration_time"
       << "Thu Jan  1 \"00\" & <2026>";
  fill(file);
  return file.releaseAndGetString();
}

TEST(ForeignCameras, WhatOpencvWritesIsReadByTheNamesThatPeopleUse) {
  struct Names {
    const char *matrix, *lens, *width, *height;
  };
  for (const std::string kind : {".xml", ".yaml", ".json"})
    for (const Names& names :
         {Names{"camera_matrix", "distortion_coefficients", "image_width", "image_height"},
          {"cameraMatrix", "distCoeffs", "imageWidth", "imageHeight"},
          {"Camera_Matrix", "Distortion_Coefficients", "image_Width", "image_Height"},
          {"K", "D", "calibration_image_width", "calibration_image_height"},
          {"M1", "D1", "image_width", "image_height"},
          {"K", "dist_coeffs", "image_size", ""}}) {
      const std::string text = written_by_opencv(kind, [&](cv::FileStorage& file) {
        if (*names.height == '\0') {
          file << names.width << cv::Size(752, 480);
        } else {
          file << names.width << 752 << names.height << 480;
        }
        file << names.matrix << matrix_of_bent << names.lens << lens_of_bent.t();
      });
      EXPECT_EQ(parse_camera_file(text, "c" + kind, ""), bent) << text;
    }
}

TEST(ForeignCameras, ListsOfPythonsUsersAreReadAsMatrices) {
  const std::string text =
      "K: [[458.6, 0, 367.2], [0, 457.2, 248.3], [0, 0, 1]]\nD: [-0.28, 0.07, 0.0001, -0.0002, 0.01]\n"
      "width: 752\nheight: 480\n";
  EXPECT_EQ(parse_camera_file(text, "c.yaml", ""), bent);
}

TEST(ForeignCameras, CoefficientsAreFoundByTheNamesInUseAndOtherNamesRefused) {
  const std::string k =
      "camera_matrix: [[458.6, 0, 367.2], [0, 457.2, 248.3], [0, 0, 1]]\nwidth: 752\nheight: 480\n";
  for (const char* key : {"dist_coeff", "dist_coefs", "distortion_coefficients", "dist", "D", "dist_coeffs",
                          "distortion_coeffs", "kc"})
    for (const char* list : {"[-0.28, 0.07, 0.0001, -0.0002, 0.01]", "[[-0.28, 0.07, 0.0001, -0.0002, 0.01]]",
                             "[[-0.28], [0.07], [0.0001], [-0.0002], [0.01]]"})
      EXPECT_EQ(parse_camera_file(k + key + ": " + list + "\n", "c.yaml", ""), bent) << key << list;
  for (const char* key : {"coeffs", "distCo", "my_dist", "Coefs"}) {
    const std::string sentence = refusal_of(k + key + ": [-0.28, 0.07, 0.0001, -0.0002, 0.01]\n");
    EXPECT_NE(sentence.find(key), std::string::npos) << key << sentence;
    EXPECT_NE(sentence.find("as distortion_coefficients, got another name"), std::string::npos) << sentence;
  }
  EXPECT_NE(refusal_of(k + "dist: [[1, 2], [3, 4]]\n").find("expected one row of numbers"),
            std::string::npos);
  EXPECT_EQ(refusal_of(k + "distance: 3\n"), "");
}

TEST(ForeignCameras, FourCoefficientsAreThoseOfTheLensThatIsNamedOrStatedBeside) {
  const std::string file =
      "K: [[458.6, 0, 367.2], [0, 457.2, 248.3], [0, 0, 1]]\nwidth: 752\nheight: 480\n"
      "D: [0.05, -0.01, 0.003, -0.001]\n";
  CameraIntrinsics fisheye{752, 480, 458.6, 457.2, 367.2, 248.3, {0.05, -0.01, 0.003, -0.001}};
  const CameraIntrinsics plumb_bob = fisheye;
  fisheye.lens = LensModel::fisheye;
  std::string note;
  const auto read = [&](const std::string& more, std::optional<LensModel> lens = {}) {
    note.clear();
    return parse_camera_file(file + more, "c.yaml", "", false, {}, lens, &note);
  };
  for (const char* model : {"model: fisheye\n", "camera_model: fisheye\n", "distortion_model: equidistant\n",
                            "distortion_model: fisheye\n", "camera_model: KannalaBrandt\n"}) {
    EXPECT_EQ(read(model), fisheye) << model;
    EXPECT_EQ(note, "");
  }
  EXPECT_EQ(read("model: D435\n"), plumb_bob);
  EXPECT_NE(note.find("camera file 'c.yaml' has four coefficients and names no lens"), std::string::npos);
  EXPECT_EQ(read("", LensModel::fisheye), fisheye);
  EXPECT_EQ(note, "");
  EXPECT_EQ(read("", LensModel::plumb_bob), plumb_bob);
  EXPECT_EQ(note, "");
  EXPECT_NE(complaint([&] {
              read("model: fisheye\n", LensModel::plumb_bob);
            }).find("its lens is fisheye, expected plumb_bob"),
            std::string::npos);
  EXPECT_NE(complaint([&] { read("camera_model: omni\n"); }).find("the lens 'omni' is not known"),
            std::string::npos);
  const TemporaryFolder folder;
  folder.write("c.yaml", file);
  const auto setup = [&](const std::string& more) {
    return load_setup(folder.write("s.yaml", "camera: {file: c.yaml" + more + "}\n"));
  };
  EXPECT_EQ(setup(", lens: fisheye").camera, fisheye);
  EXPECT_TRUE(setup(", lens: fisheye").source.notes.empty());
  EXPECT_EQ(setup("").camera, plumb_bob);
  ASSERT_EQ(setup("").source.notes.size(), 1U);
  EXPECT_NE(setup("").source.notes[0].find("`lens: fisheye` beside `file`"), std::string::npos);
}

TEST(ForeignCameras, EurocsSensorAndReplicasCameraAreRead) {
  const std::string euroc =
      "#Default\nsensor_type: camera\nT_BS:\n  cols: 4\n  rows: 4\n  data: "
      "[1,0,0,0,0,1,0,0,0,0,1,0,0,0,0,1]\n"
      "rate_hz: 20\nresolution: [752, 480]\ncamera_model: pinhole\nintrinsics: [458.6, 457.2, 367.2, 248.3] "
      "#fu\n"
      "distortion_model: radial-tangential\ndistortion_coefficients: [-0.28, 0.07, 0.0001, -0.0002]\n";
  CameraIntrinsics expected = bent;
  expected.distortion[4] = 0.0;
  EXPECT_EQ(parse_camera_file(euroc, "sensor.yaml", ""), expected);
  EXPECT_EQ(
      parse_camera_file(R"({"camera": {"w": 752, "h": 480, "fx": 458.6, "fy": 457.2, "cx": 367.2, "cy": 248.3,
                                  "scale": 6553.5}})",
                        "cam_params.json", ""),
      (CameraIntrinsics{752, 480, 458.6, 457.2, 367.2, 248.3, {}}));
}

/// Double sphere, extended unified, a rational lens, a thin prism: none is a pinhole without its numbers.
TEST(ForeignCameras, NumbersOfLensesThatAPlumbBobDoesNotHaveAreRefused) {
  const std::string plain =
      R"("width": 752, "height": 480, "fx": 458.6, "fy": 457.2, "cx": 367.2, "cy": 248.3)";
  const CameraIntrinsics pinhole{752, 480, 458.6, 457.2, 367.2, 248.3, {}};
  for (const char* more : {R"("xi": -0.2, "alpha": 0.5)", R"("camera_model": "eucm")", R"("model": "ds")",
                           R"("k1": 0.1, "k5": 0.1)", R"("k6": 0.1)", R"("r1": 0.1, "t1": 0.2)",
                           R"("skew": 3)", R"("camera_model": "unified")", R"("s1": 0.01)"})
    for (const char* form : {"{%}", R"({"camera": {%}})"}) {
      std::string text = form;
      text.replace(text.find('%'), 1, plain + ", " + more);
      EXPECT_NE(refusal_of(text), "") << text;
    }
  for (const char* more :
       {R"("k4": 0, "k5": 0.0)", R"("skew": 0)", R"("model": "D435")", R"("alpha": "none")"})
    EXPECT_EQ(parse_camera_file("{" + plain + ", " + more + "}", "c.json", ""), pinhole) << more;
}

TEST(ForeignCameras, AnInfoFileHasTwoCamerasAndNamesWhatIsWrong) {
  const std::string info =
      "m_versionNumber = 4\nm_colorWidth = 1296\nm_colorHeight = 968\nm_depthWidth = 640\nm_depthHeight = "
      "480\n"
      "m_depthShift = 1000\nm_calibrationColorIntrinsic = 1170.2 0 647.75 0 0 1170.3 483.75 0 0 0 1 0 0 0 0 "
      "1 \n"
      "m_calibrationDepthIntrinsic = 571.6 0 319.5 0 0 571.7 239.5 0 0 0 1 0 0 0 0 1\n";
  const CameraIntrinsics depth{640, 480, 571.6, 571.7, 319.5, 239.5, {}};
  EXPECT_EQ(parse_camera_file(info, "info.txt", ""), depth);
  EXPECT_EQ(parse_camera_file(info, "info.txt", "depth", false, ImageSize{640, 480}), depth);
  EXPECT_EQ(parse_camera_file(info, "info.txt", "color"),
            (CameraIntrinsics{1296, 968, 1170.2, 1170.3, 647.75, 483.75, {}}));
  EXPECT_NE(refusal_of(info, "left").find("no camera 'left', expected 'depth' or 'color'"),
            std::string::npos);
  EXPECT_NE(refusal_of(info, "", ImageSize{320, 240}).find("640 x 480 pixels, expected 320 x 240"),
            std::string::npos);
  for (const auto& [from, to, words] : std::vector<std::array<std::string, 3>>{
           {"m_depthWidth = 640", "m_depthWidth = 6e9", "field 'm_depthWidth': expected a number from 1 to"},
           {"m_depthHeight = 480", "m_depthHeight 480", "field 'm_depthHeight': expected a number after"},
           {"m_depthShift = 1000", "m_depthShift = 0", "field 'm_depthShift'"},
           {"571.6 0 319.5 0", "571.6 0 319.5", "field 'm_calibrationDepthIntrinsic': expected 16 numbers"},
           {"571.6 0", "-571.6 0", "field 'm_calibrationDepthIntrinsic': expected a camera's matrix"},
           {"571.6 0", "nan 0", "field 'm_calibrationDepthIntrinsic': expected 16 numbers"}}) {
    std::string text = info;
    text.replace(text.find(from), from.size(), to);
    EXPECT_NE(refusal_of(text).find(words), std::string::npos) << refusal_of(text);
  }
}

TEST(ForeignCameras, OfAStereoPairOneIsNamedAndASizeIsStatedElsewhere) {
  for (const std::string kind : {".xml", ".yml"}) {
    const std::string text = written_by_opencv(kind, [&](cv::FileStorage& file) {
      file << "M1" << matrix_of_bent << "D1" << lens_of_bent;
      file << "M2" << cv::Mat(matrix_of_bent.mul(2.0) - cv::Mat::diag(cv::Mat(cv::Vec3d(0, 0, 1))));
      file << "D2" << cv::Mat::zeros(1, 5, CV_64F);
    });
    EXPECT_EQ(parse_camera_file(text, "c", "M1", false, ImageSize{752, 480}), bent);
    EXPECT_EQ(parse_camera_file(text, "c", "M2", false, ImageSize{752, 480}),
              (CameraIntrinsics{752, 480, 917.2, 914.4, 734.4, 496.6, {}}));
    EXPECT_NE(refusal_of(text, "", ImageSize{752, 480}).find("several cameras, M1, M2"), std::string::npos);
    EXPECT_NE(refusal_of(text, "M1").find("how large the pictures are"), std::string::npos)
        << refusal_of(text, "M1");
  }
}

TEST(ForeignCameras, OfTheProgramsThatRobotTeamsCalibrateWithAreRead) {
  const std::string photonvision =
      R"({"resolution": {"width": 752.0, "height": 480.0}, "cameraIntrinsics": {"rows": 3, "cols": 3, "type": 6,
"data": [458.6, 0.0, 367.2, 0.0, 457.2, 248.3, 0.0, 0.0, 1.0]}, "distCoeffs": {"rows": 1, "cols": 8, "type": 6,
"data": [-0.28, 0.07, 0.0001, -0.0002, 0.01, 0.0, 0.0, 0.0]}, "calobjectWarp": [0.0, 0.0]})";
  const std::string limelight =
      R"({"camera_model": "opencv", "camera_matrix": [[458.6, 0, 367.2], [0, 457.2, 248.3], [0, 0, 1]],
"distortion_coefficients": [[-0.28, 0.07, 0.0001, -0.0002, 0.01]], "img_size": [752, 480]})";
  for (const std::string& text : {photonvision, limelight})
    EXPECT_EQ(parse_camera_file(text, "c.json", "", false, {}), bent) << text;
}

TEST(ForeignCameras, DamagedStoragesAreRefusedInOneSentenceAndOpencvSaysNothing) {
  const std::string whole = written_by_opencv(".xml", [](cv::FileStorage& file) {
    file << "image_width" << 752 << "image_height" << 480 << "camera_matrix" << matrix_of_bent;
  });
  testing::internal::CaptureStderr();
  EXPECT_EQ(refusal_of(whole), "");
  std::string deep = "<?xml version=\"1.0\"?><opencv_storage>";
  for (int i = 0; i < 100'000; ++i) deep += "<a>";
  for (const auto& [text, words] : std::vector<std::pair<std::string, std::string>>{
           {whole.substr(0, whole.size() / 2), "not valid XML"},
           {"<?xml version=\"1.0\"?><robot/>", "`opencv_storage`"},
           {deep, "32 elements"},
           {"<opencv_storage><K><_>1</_><b>2</b></K></opencv_storage>",
            "line 1: expected either elements '_'"},
           {"<opencv_storage>\n\n<image_width>nan</image_width></opencv_storage>", "camera_matrix"},
           {"<opencv_storage><image_width>752</image_width><image_height>480</image_height>\n<K>"
            "<data>1 0 0\n0 1 0 0 0 nan</data></K></opencv_storage>",
            "line 2, K.data"},
           {"<opencv_storage><Kamera>5</Kamera></opencv_storage>", "expected kalibr's camchain"}}) {
    const std::string sentence = refusal_of(text);
    EXPECT_NE(sentence.find(words), std::string::npos) << sentence;
    EXPECT_NE(sentence.find("c.file"), std::string::npos) << sentence;
    EXPECT_EQ(sentence.find('\n'), std::string::npos) << sentence;
  }
  for (std::size_t cut = 0; cut < whole.size() - 20; ++cut) EXPECT_NE(refusal_of(whole.substr(0, cut)), "");
  EXPECT_EQ(testing::internal::GetCapturedStderr(), "");
  const std::string other =
      "image_width: 752\nimage_height: 480\ncamera_matrix: [9, 0, 3, 0, 9, 3, 0, 0, 1]\n";
  EXPECT_EQ(refusal_of(other), "");
  EXPECT_NE(refusal_of(other + "lens_distortion: [1, 2, 3, 4]\n").find("got another name"),
            std::string::npos);
  EXPECT_NE(refusal_of(other + "D: [0, 0, 0, 0]\ndistCoeffs: [0, 0, 0, 0]\n").find("one list of coeff"),
            std::string::npos);
  EXPECT_NE(refusal_of(other, "", ImageSize{640, 480}).find("752 x 480 pixels, expected 640 x 480"),
            std::string::npos);
}

std::string realsense(const std::string& model, const std::string& coefficients) {
  return R"({"width": 640, "height": 480, "ppx": 321.5, "ppy": 239.25, "fx": 610.5, "fy": 611.25, "model": )" +
         model + R"(, "coeffs": [)" + coefficients + "]}";
}

/// librealsense's rs2_project_point_to_pixel of these two lenses, by its formulas.
Eigen::Vector2d projected(bool is_fisheye, const std::array<double, 5>& c, const Eigen::Vector2d& at) {
  const double r2 = at.squaredNorm(), x = at.x(), y = at.y();
  Eigen::Vector2d bent_ray;
  if (is_fisheye) {
    const double r = std::sqrt(r2), theta = std::atan(r), t2 = theta * theta;
    bent_ray = at * (theta * (1 + t2 * (c[0] + t2 * (c[1] + t2 * (c[2] + t2 * c[3])))) / r);
  } else {
    const double f = 1 + c[0] * r2 + c[1] * r2 * r2 + c[4] * r2 * r2 * r2;
    bent_ray = {x * f + 2 * c[2] * x * y + c[3] * (r2 + 2 * x * x),
                y * f + 2 * c[3] * x * y + c[2] * (r2 + 2 * y * y)};
  }
  return {bent_ray.x() * 610.5 + 321.5, bent_ray.y() * 611.25 + 239.25};
}

TEST(ForeignCameras, RealsensesLensesProjectAsLibrealsenseDoes) {
  for (const auto& [model, is_fisheye] : {std::pair{"\"Brown Conrady\"", false},
                                          {"\"distortion.brown_conrady\"", false},
                                          {"\"RS2_DISTORTION_BROWN_CONRADY\"", false},
                                          {"4", false},
                                          {"\"Kannala Brandt4\"", true},
                                          {"5", true}}) {
    const std::string last = is_fisheye ? "0" : "0.02";
    const CameraIntrinsics camera =
        parse_camera_file(realsense(model, "0.05, -0.03, 0.004, -0.002, " + last), "c.json", "");
    const Lens lens(camera);
    for (const Eigen::Vector2d& at : {Eigen::Vector2d(0.3, -0.2), {-0.4, 0.1}, {0.05, 0.35}}) {
      const auto pixel = lens.project({at.x(), at.y(), 1.0});
      ASSERT_TRUE(pixel);
      EXPECT_LT((*pixel - projected(is_fisheye, {0.05, -0.03, 0.004, -0.002, 0.02}, at)).norm(), 1e-9)
          << model;
    }
  }
}

TEST(ForeignCameras, RealsensesOtherFormulasAreNotTakenForOpencvs) {
  const CameraIntrinsics straight{640, 480, 610.5, 611.25, 321.5, 239.25, {}};
  for (const std::string model :
       {"\"Inverse Brown Conrady\"", "\"Modified Brown Conrady\"", "1", "2", "0",
        "\"distortion.inverse_brown_conrady\"", "\"None\"", "\"distortion.none\""}) {
    EXPECT_EQ(parse_camera_file(realsense(model, "0, 0.0, 0, 0, 0"), "c.json", ""), straight) << model;
    EXPECT_NE(refusal_of(realsense(model, "0, 0, 0, 0, 1e-6")).find("coefficients that are all 0"),
              std::string::npos)
        << model;
  }
  EXPECT_NE(refusal_of(realsense("\"F-Theta\"", "0, 0, 0, 0, 0")).find("'F-Theta' is none of OpenCV's"),
            std::string::npos);
  EXPECT_NE(refusal_of(realsense("\"Fancy\"", "0, 0, 0, 0, 0")), "");
  EXPECT_NE(refusal_of(realsense("\"Brown Conrady\"", "0, 0")).find("expected 5 numbers"), std::string::npos);
}

TEST(ForeignCameras, OneOfSeveralStreamsIsNamed) {
  const std::string color = realsense("\"Brown Conrady\"", "0, 0, 0, 0, 0");
  const std::string both =
      "{\"serial\": \"0123\", \"depth\": {\"intrinsics\": " + color + "},\n\t\"color\":" + color + "}";
  EXPECT_EQ(parse_camera_file(both, "c.json", "depth"), parse_camera_file(color, "c.json", ""));
  EXPECT_EQ(parse_camera_file(both, "c.json", "color"), parse_camera_file(color, "c.json", ""));
  EXPECT_NE(refusal_of(both).find("it has 'depth.intrinsics', 'color': expected"), std::string::npos);
  EXPECT_NE(refusal_of(both, "infrared").find("no camera 'infrared'"), std::string::npos);
  std::string many = "{";
  for (int i = 0; i < 40; ++i) many += (i == 0 ? "\"s" : ", \"s") + std::to_string(i) + "\": " + color;
  EXPECT_NE(refusal_of(many + "}").find("'s19' and 20 more: expected"), std::string::npos)
      << refusal_of(many + "}");
  const std::string hostile = refusal_of("{\"a\\e[2J\": {\"ppx\": 3}}");
  EXPECT_NE(hostile.find("a\\x1b[2J.image_width"), std::string::npos) << hostile;
}

/// As open3d.io.write_pinhole_camera_intrinsic writes it, with tabs.
const std::string open3d =
    "{\n\t\"class_name\" : \"PinholeCameraIntrinsic\",\n\t\"height\" : 480,\n\t\"intrinsic_matrix\" : \n\t[\n"
    "\t\t525.5,\n\t\t0.0,\n\t\t0.0,\n\t\t0.0,\n\t\t526.0,\n\t\t0.0,\n\t\t319.5,\n\t\t239.25,\n\t\t1.0\n\t],\n"
    "\t\"version_major\" : 1,\n\t\"width\" : 640\n}";

TEST(ForeignCameras, Open3dsMatrixStandsColumnByColumn) {
  const CameraIntrinsics expected{640, 480, 525.5, 526.0, 319.5, 239.25, {}};
  EXPECT_EQ(parse_camera_file(open3d, "c.json", ""), expected);
  EXPECT_EQ(parse_camera_file("{\"extrinsic\": [1, 0], \"intrinsic\": " + open3d + "}", "c.json", ""),
            expected);
  CameraIntrinsics rectified = expected;
  rectified.is_rectified = true;
  EXPECT_EQ(parse_camera_file(open3d, "c.json", "", true), rectified);
  const std::string rows =
      R"({"width": 640, "height": 480, "intrinsic_matrix": [525.5, 0, 319.5, 0, 526, 239.25, 0, 0, 1]})";
  EXPECT_NE(
      refusal_of(rows).find("intrinsic_matrix: expected [fx, 0, 0, 0, fy, 0, cx, cy, 1] column by column"),
      std::string::npos);
}

TEST(ForeignCameras, AMatrixAloneNeedsASizeFromElsewhere) {
  const std::string scannet = "577.5 0.0 318.75 0.0\n0 578.5 242.5 0\n0 0 1 0\n0 0 0 1\n";
  const CameraIntrinsics expected{640, 480, 577.5, 578.5, 318.75, 242.5, {}};
  const ImageSize size{640, 480};
  EXPECT_EQ(parse_camera_file(scannet, "c.txt", "", false, size), expected);
  EXPECT_EQ(
      parse_camera_file("# K\n 5.775e+02\t0\t318.75\n 0,+578.5,242.5\r\n0 0 1\n", "c.txt", "", false, size),
      expected);
  EXPECT_EQ(parse_camera_file("577.5 578.5 318.75 242.5\n", "calibration.txt", "", false, size), expected);
  EXPECT_NE(refusal_of("577.5 578.5 318.75 242.5\n").find("expected `width` and"), std::string::npos);
  EXPECT_NE(refusal_of(scannet).find("expected `width` and `height` beside `file`"), std::string::npos);
  for (const char* other :
       {"577.5 0 0\n0 578.5 0\n318.75 242.5 1\n", "577.5 0 318.75\n0 578.5 242.5\n",
        "577.5 2 318.75\n0 578.5 242.5\n0 0 1\n", "-577.5 0 318.75\n0 578.5 242.5\n0 0 1\n",
        "577.5 0 318.75 0 578.5 242.5 0 0 1\n", "5.7e8 0 318.75\n0 578.5 242.5\n0 0 1\n",
        "577.5 0 318.75 242.5\n", "577.5 578.5 318.75\n",
        "577.5 0 318.75 1\n0 578.5 242.5 0\n0 0 1 0\n0 0 0 1\n", "7\n"}) {
    EXPECT_NE(refusal_of(other, "", size).find("expected a matrix of 3 or 4 rows"), std::string::npos)
        << other;
  }
  const TemporaryFolder folder;
  folder.write("k.txt", scannet);
  folder.write("s.yaml", "camera: {file: k.txt, width: 640, height: 480}\n");
  EXPECT_EQ(load_setup(folder.file("s.yaml")).camera, expected);
}

/// nerfstudio's data format (docs.nerf.studio, "Data Conventions"): the middle of the first pixel is at 0.5.
TEST(NerfCamera, ACameraOfAllPicturesIsReadAndOthersAreRefused) {
  const auto file = [](const std::string& camera, const std::vector<std::string>& frames) {
    std::string text = "{" + camera + ", \"applied_scale\": 0.5, \"frames\": [";
    for (const std::string& frame : frames)
      text += (text.back() == '[' ? "{" : ", {") + frame +
              "\"file_path\": \"a.png\", \"transform_matrix\": [[2, 0, 0, 0], [0, 2, 0, 0], [0, 0, 2, 0], "
              "[0, 0, 0, 1]]}";
    return text + "]}";
  };
  const std::string numbers =
      "\"camera_model\": \"OPENCV\", \"fl_x\": 500.5, \"fl_y\": 510, \"cx\": 320, \"cy\": 241, \"w\": 640, "
      "\"h\": "
      "480, \"k1\": -0.1, \"k2\": 0.05, \"p1\": 0.01, \"p2\": -0.02";
  const CameraIntrinsics camera = parse_camera_file(file(numbers, {"", ""}), "transforms.json", "");
  EXPECT_EQ(camera, (CameraIntrinsics{640, 480, 500.5, 510, 319.5, 240.5, {-0.1, 0.05, 0.01, -0.02}}));
  EXPECT_EQ(parse_camera_file("{" + numbers + "}", "transforms.json", ""), camera);
  EXPECT_EQ(parse_camera_file(file("\"fps\": 30", {numbers + ", ", numbers + ", "}), "transforms.json", ""),
            camera);

  const std::string angle = file("\"camera_angle_x\": 1.5707963267948966", {""});
  EXPECT_NEAR(parse_camera_file(angle, "transforms.json", "", false, ImageSize{640, 480}).fx, 320.0, 1e-9);
  const auto refusal = [](const std::string& text, const std::string& name = "") {
    return complaint([&] { parse_camera_file(text, "transforms.json", name); });
  };
  EXPECT_NE(refusal(angle).find("`w` and `h`"), std::string::npos) << refusal(angle);
  const std::string two = file(numbers, {"", "\"fl_x\": 500, "});
  EXPECT_NE(refusal(two).find("cameras of their own"), std::string::npos) << refusal(two);
  EXPECT_NE(refusal(file(numbers, {""}), "left").find("no `name`"), std::string::npos);
  EXPECT_NE(refusal(file(numbers, {})).find("at least one frame"), std::string::npos);
}

}  // namespace foreign_cameras_test
}  // namespace clearway
