// COLMAP's and camodocal's cameras, against the formulas of their own sources, written here a second time.

#include "datasets/cameras/colmap_camera.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <sstream>
#include <string>
#include <vector>

#include "datasets/camera_files/camera_file.hpp"
#include "datasets/sources/lens.hpp"
#include "mapping/system/byte_reader.hpp"
#include "tests/datasets/complaint.hpp"

namespace clearway {
namespace colmap_camera_test {

CameraIntrinsics read(const std::string& text, const std::string& name = "") {
  return parse_camera_file(text, "cameras.txt", name);
}

std::string refusal(const std::string& text, const std::string& name = "") {
  return complaint([&] { read(text, name); });
}

const std::string head =
    "# Camera list with one line of data per camera:\n#   CAMERA_ID, MODEL, WIDTH, HEIGHT, PARAMS[]\n";

/// COLMAP (sensor/models.h) has the middle of the first pixel at 0.5.
void expect_pixel(const CameraIntrinsics& camera, const Eigen::Vector2d& of_colmap,
                  const Eigen::Vector2d& ray) {
  const auto pixel = Lens(camera).project({ray.x(), ray.y(), 1.0});
  ASSERT_TRUE(pixel);
  EXPECT_LT((*pixel - (of_colmap - Eigen::Vector2d(0.5, 0.5))).norm(), 1e-9);
}

TEST(ColmapCamera, ProjectsAsColmapDoesButForTheHalfPixel) {
  const Eigen::Vector2d ray(0.31, -0.22);
  const double r2 = ray.squaredNorm(), x = ray.x(), y = ray.y();
  const Eigen::Vector2d centre(320, 240);
  expect_pixel(read(head + "1 PINHOLE 640 480 500 510 320 240\n"), {500 * x + 320, 510 * y + 240}, ray);
  expect_pixel(read("3 SIMPLE_PINHOLE 640 480 500 320 240\n"), 500 * ray + centre, ray);
  expect_pixel(read(head + "1 SIMPLE_RADIAL 640 480 500 320 240 -0.1\n"), 500 * (1 - 0.1 * r2) * ray + centre,
               ray);
  expect_pixel(read("1 RADIAL 640 480 500 320 240 -0.1 0.05\n"),
               500 * (1 - 0.1 * r2 + 0.05 * r2 * r2) * ray + centre, ray);
  const double k1 = -0.1, k2 = 0.05, p1 = 0.01, p2 = -0.02, radial = 1 + k1 * r2 + k2 * r2 * r2;
  const Eigen::Vector2d bent(x * radial + 2 * p1 * x * y + p2 * (r2 + 2 * x * x),
                             y * radial + 2 * p2 * x * y + p1 * (r2 + 2 * y * y));
  expect_pixel(read("1 OPENCV 640 480 500 510 320 240 -0.1 0.05 0.01 -0.02\n"),
               {500 * bent.x() + 320, 510 * bent.y() + 240}, ray);
  const double six = (1 + k1 * r2 + k2 * r2 * r2 + 0.03 * r2 * r2 * r2) /
                     (1 + 0.02 * r2 - 0.01 * r2 * r2 + 0.005 * r2 * r2 * r2);
  expect_pixel(read("1 FULL_OPENCV 640 480 500 510 320 240 -0.1 0.05 0 0 0.03 0.02 -0.01 0.005\n"),
               {500 * x * six + 320, 510 * y * six + 240}, ray);
  const double angle = std::atan(std::sqrt(r2)), t2 = angle * angle;
  const double wide = angle *
                      (1 + 0.1 * t2 - 0.02 * t2 * t2 + 0.01 * std::pow(t2, 3) + 0.003 * std::pow(t2, 4)) /
                      std::sqrt(r2);
  const double radial_wide = angle * (1 + 0.1 * t2 - 0.02 * t2 * t2) / std::sqrt(r2);
  expect_pixel(read("1 RADIAL_FISHEYE 640 480 500 320 240 0.1 -0.02\n"), 500 * radial_wide * ray + centre,
               ray);
  expect_pixel(read("1 SIMPLE_RADIAL_FISHEYE 640 480 500 320 240 0.1\n"),
               500 * angle * (1 + 0.1 * t2) / std::sqrt(r2) * ray + centre, ray);
  expect_pixel(read("1 SIMPLE_FISHEYE 640 480 500 320 240\n"), 500 * angle / std::sqrt(r2) * ray + centre,
               ray);
  expect_pixel(read("1 FISHEYE 640 480 500 510 320 240\n"),
               {500 * angle / std::sqrt(r2) * x + 320, 510 * angle / std::sqrt(r2) * y + 240}, ray);
  expect_pixel(read("1 OPENCV_FISHEYE 640 480 500 510 320 240 0.1 -0.02 0.01 0.003\n"),
               {500 * wide * x + 320, 510 * wide * y + 240}, ray);
}

TEST(ColmapCamera, OneOfSeveralIsNamedAndWhatIsNoneIsRefusedInOneSentence) {
  const std::string two = head + "1 PINHOLE 640 480 500 500 320 240\n7 PINHOLE 64 48 50 50 32 24\n";
  EXPECT_EQ(read(two, "7").width, 64);
  for (const auto& [text, name, why] : std::vector<std::array<std::string, 3>>{
           {two, "", "has cameras '1', '7': expected `camera: {file: …, name: …}`"},
           {two, "2", "none called '2'"},
           {"1 FOV 640 480 500 500 320 240 0.9\n", "",
            "line 1: the camera model 'FOV' is not known here, expected"},
           {head + "1 PINHOLE 640 480 500 500 320\n", "", "line 3: expected 6 numbers behind PINHOLE, got 5"},
           {"1 PINHOLE 640 480 500 x 320 240\n", "", "expected a number from -1e6 to 1e6, got 'x'"},
           {"1 PINHOLE 640 480 500 nan 320 240\n", "", "expected a number from -1e6 to 1e6, got 'nan'"},
           {"1 PINHOLE 640 480 500 1e7 320 240\n", "", "expected a number from -1e6 to 1e6"},
           {"1 PINHOLE 640 480\n", "", "expected 6 numbers behind PINHOLE, got 2"},
           {"1 PINHOLE 640.5 480 500 500 320 240\n", "", "a width and a height of 32 to 20000"},
           {"1 PINHOLE 1e5 480 500 500 320 240\n", "", "a width and a height of 32 to 20000"},
           {"1 PINHOLE 640 480 500 500 320 240\n", "7", "none called '7'"},
           {"1 SIMPLE_PINHOLE 640 480 -500 320 240\n", "", "focal lengths above 0"}}) {
    const std::string sentence = refusal(text, name);
    EXPECT_NE(sentence.find(why), std::string::npos) << sentence;
    EXPECT_NE(sentence.find("cameras.txt"), std::string::npos) << sentence;
  }
}

TEST(ColmapCamera, TheLensThatTheSetupStatesHasToAgree) {
  const std::string text = "1 PINHOLE 640 480 500 500 320 240\n";
  EXPECT_NE(complaint([&] {
              parse_camera_file(text, "cameras.txt", "", false, {}, LensModel::fisheye);
            }).find("its lens is plumb_bob, expected fisheye"),
            std::string::npos);
}

/// PinholeCamera and EquidistantCamera of camodocal, as VINS takes them; the names in any letters.
TEST(ColmapCamera, CamodocalsPinholeAndItsFisheyeAreKnown) {
  const std::string size = "%YAML:1.0\n---\ncamera_name: camera\nimage_width: 752\nimage_height: 480\n";
  const CameraIntrinsics pinhole{752, 480, 461.6, 460.3, 363, 248.1, {-0.29, 0.08, 5e-05, -1.5e-04}};
  const std::string parameters =
      "distortion_parameters:\n   k1: -0.29\n   k2: 0.08\n   p1: 5.0e-05\n   p2: -1.5e-04\n"
      "projection_parameters:\n   fx: 461.6\n   fy: 460.3\n   cx: 363\n   cy: 248.1\n";
  for (const char* type : {"PINHOLE", "pinhole"})
    EXPECT_EQ(read(size + "model_type: " + type + "\n" + parameters), pinhole);
  CameraIntrinsics straight = pinhole;
  straight.distortion = {};
  EXPECT_EQ(read(size + "model_type: PINHOLE\n" + parameters.substr(parameters.find("projection"))),
            straight);
  EXPECT_NE(refusal(size + parameters).find("expected PINHOLE or KANNALA_BRANDT, got 'none'"),
            std::string::npos);
  CameraIntrinsics wide{752, 480, 461.6, 460.3, 363, 248.1, {0.1, -0.02, 0.01, 0.003}};
  wide.lens = LensModel::fisheye;
  EXPECT_EQ(read(size +
                 "model_type: KANNALA_BRANDT\nprojection_parameters:\n   k2: 0.1\n   k3: -0.02\n   k4: 0.01\n"
                 "   k5: 0.003\n   mu: 461.6\n   mv: 460.3\n   u0: 363\n   v0: 248.1\n"),
            wide);
  EXPECT_NE(refusal(size + "model_type: MEI\nmirror_parameters: {xi: 2}\n" + parameters)
                .find("expected PINHOLE or KANNALA_BRANDT, got 'MEI'"),
            std::string::npos);
}

/// cameras.bin as COLMAP writes it (scene/reconstruction_io_binary.cc).
std::string binary(const std::vector<std::string>& lines) {
  const std::vector<std::string> models{"SIMPLE_PINHOLE",
                                        "PINHOLE",
                                        "SIMPLE_RADIAL",
                                        "RADIAL",
                                        "OPENCV",
                                        "OPENCV_FISHEYE",
                                        "FULL_OPENCV",
                                        "FOV",
                                        "SIMPLE_RADIAL_FISHEYE",
                                        "RADIAL_FISHEYE",
                                        "THIN_PRISM_FISHEYE",
                                        "RAD_TAN_THIN_PRISM_FISHEYE",
                                        "SIMPLE_DIVISION",
                                        "DIVISION",
                                        "SIMPLE_FISHEYE",
                                        "FISHEYE",
                                        "EUCM",
                                        "EQUIRECTANGULAR"};
  std::string bytes;
  put(bytes, std::uint64_t{lines.size()});
  for (const std::string& line : lines) {
    std::istringstream words(line);
    std::uint32_t id = 0;
    std::string model;
    std::uint64_t width = 0, height = 0;
    words >> id >> model >> width >> height;
    put(bytes, id);
    put(bytes, static_cast<std::int32_t>(std::find(models.begin(), models.end(), model) - models.begin()));
    put(bytes, width);
    put(bytes, height);
    for (double number = 0.0; words >> number;) put(bytes, number);
  }
  return bytes;
}

TEST(ColmapCamera, TheBinaryFileHasTheSameCameras) {
  const std::vector<std::string> lines{
      "1 SIMPLE_PINHOLE 640 480 500.25 320 240",
      "2 PINHOLE 640 480 500 510 320 240",
      "3 SIMPLE_RADIAL 640 480 500 320 240 -0.1",
      "4 RADIAL 640 480 500 320 240 -0.1 0.05",
      "5 OPENCV 640 480 500 510 320 240 -0.1 0.05 0.01 -0.02",
      "6 OPENCV_FISHEYE 640 480 500 510 320 240 -0.1 0.05 0.01 -0.02",
      "7 FULL_OPENCV 640 480 500 510 320 240 -0.1 0.05 0 0 0.03 0.02 -0.01 0.005",
      "12 SIMPLE_RADIAL_FISHEYE 1920 1080 500 960.5 540.123456789 0.1",
      "9 RADIAL_FISHEYE 640 480 500 320 240 0.1 -0.02",
      "14 SIMPLE_FISHEYE 640 480 500 320 240",
      "15 FISHEYE 640 480 500 510 320 240"};
  const std::string all = binary(lines);
  for (const std::string& line : lines) {
    const std::string id = line.substr(0, line.find(' '));
    EXPECT_EQ(read(all, id), read(line)) << line;
    EXPECT_EQ(read(binary({line})), read(line)) << line;
  }
  EXPECT_NE(refusal(all).find("has cameras '1', '2', "), std::string::npos) << refusal(all);
  EXPECT_NE(refusal(binary({"4 FOV 640 480 500 500 320 240 0.9"}))
                .find("'cameras.txt', camera 4: the camera model 'FOV' is not known here"),
            std::string::npos);
  for (const char* line :
       {"1 THIN_PRISM_FISHEYE 640 480 500 510 320 240 0 0 0 0 0 0 0 0",
        "1 RAD_TAN_THIN_PRISM_FISHEYE 640 480 500 510 320 240 0 0 0 0 0 0 0 0 0 0 0 0",
        "1 SIMPLE_DIVISION 640 480 500 320 240 0.1", "1 DIVISION 640 480 500 510 320 240 0.1",
        "1 EUCM 640 480 500 510 320 240 0.5 1", "1 EQUIRECTANGULAR 640 480 640 480"}) {
    const std::string model = std::string(line).substr(2, std::string(line).find(' ', 2) - 2);
    const std::string said = refusal(binary({line}));
    EXPECT_NE(said.find("the camera model '" + model + "' is not known here"), std::string::npos) << said;
  }
  for (std::size_t size = 0; size < all.size(); ++size) EXPECT_NE(refusal(all.substr(0, size)), "") << size;
  EXPECT_NE(refusal(all + '\0'), "");
}

}  // namespace colmap_camera_test
}  // namespace clearway
