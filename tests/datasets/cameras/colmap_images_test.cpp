#include "datasets/cameras/colmap_images.hpp"

#include <gtest/gtest.h>

#include <cstdint>
#include <vector>

#include "mapping/system/byte_reader.hpp"
#include "tests/datasets/complaint.hpp"

namespace clearway {
namespace colmap_images_test {

constexpr char head[] =
    "# Image list with two lines of data per image:\n#   IMAGE_ID, QW, QX, QY, QZ, TX, TY, TZ, CAMERA_ID, "
    "NAME\n#   POINTS2D[] as (X, Y, POINT3D_ID)\n";

/// By hand: the camera stands at x = 2 and looks along the world's x; its x is the world's -y.
TEST(ColmapImages, PosesLeadFromTheCameraToTheWorldAndPointsAreLeftOut) {
  const std::string first = "7 0.5 0.5 -0.5 0.5 0 0 -2 1 rgb/b c.jpg\r\n", points = "1.5 2.5 -1 3 4 12\n",
                    second = "3 1 0 0 0 -1 -2 -3 1 a.jpg\n";
  for (const std::string& text : {head + first + points + second + "\n", first + "\n" + second,
                                  first + points + "# a remark\n\n" + second + points}) {
    ASSERT_TRUE(is_colmap_images(text)) << text;
    const auto images = parse_colmap_images(text, "images.txt");
    ASSERT_EQ(images.size(), 2U) << text;
    EXPECT_EQ(images[0].name, "rgb/b c.jpg");
    const Eigen::Isometry3d& pose = images[0].world_from_camera;
    EXPECT_TRUE(pose.translation().isApprox(Eigen::Vector3d(2, 0, 0), 1e-12)) << pose.translation();
    EXPECT_TRUE(pose.linear().col(2).isApprox(Eigen::Vector3d::UnitX(), 1e-12)) << pose.linear();
    EXPECT_TRUE(pose.linear().col(0).isApprox(-Eigen::Vector3d::UnitY(), 1e-12)) << pose.linear();
    EXPECT_EQ(images[1].name, "a.jpg");
    EXPECT_EQ(images[1].world_from_camera.translation(), Eigen::Vector3d(1, 2, 3));
  }
}

TEST(ColmapImages, OtherTextsAreNone) {
  for (const char* text : {"", "# time\n1 2 3 4 0 0 0 1\n", "1 0 0 0 0 1 0 0 0 0 1 0\n", "a.png\nb.png\n",
                           "3 1 0 0 0 -1 -2 -3 1\n", "3 2 0 0 0 -1 -2 -3 1 a.jpg\n"})
    EXPECT_FALSE(is_colmap_images(text)) << text;
}

TEST(ColmapImages, DamagedLinesAreRefusedByTheirNumber) {
  for (const auto& [lines, expected] :
       {std::pair<std::string, std::string>{"1 1 0 0 0 0 0 0 1 a.png\n2 1 0 0 0 0 0 0 1 b.png\n",
                                            "images.txt, line 5: expected the 2D points"},
        {"1 1 0 0 0 0 0 0 1 a.png\n1 2\n", "line 5: expected the 2D points"},
        {"1 1 0 0 0 0 0 0 1\n\n", "line 4: expected 'IMAGE_ID QW"},
        {"1 0 0 0 0 0 0 0 1 a.png\n\n", "with a unit quaternion"},
        {"1 1 0 0 0 nan 0 0 1 a.png\n\n", "line 4: expected 'IMAGE_ID QW"},
        {"", "images.txt: expected at least one image"}}) {
    const std::string said =
        complaint([&, lines = lines] { parse_colmap_images(head + lines, "images.txt"); });
    EXPECT_NE(said.find(expected), std::string::npos) << said;
  }
}

/// images.bin as COLMAP writes it (scene/reconstruction_io_binary.cc): with `points` of each image.
std::string binary(const std::vector<std::pair<std::vector<double>, std::string>>& images,
                   std::size_t points = 3) {
  std::string bytes;
  put(bytes, std::uint64_t{images.size()});
  std::uint32_t number = 7;
  for (const auto& [pose, name] : images) {
    put(bytes, number++);
    for (const double value : pose) put(bytes, value);
    put(bytes, std::uint32_t{1});
    bytes += name + '\0';
    put(bytes, std::uint64_t{points});
    for (std::size_t i = 0; i < points; ++i) {
      put(bytes, 1.5);
      put(bytes, 2.5);
      put(bytes, std::int64_t{-1});
    }
  }
  return bytes;
}

const std::vector<double> along_x{0.5, 0.5, -0.5, 0.5, 0, 0, -2}, back{1, 0, 0, 0, -1, -2, -3};

TEST(ColmapImages, TheBinaryFileHasTheSameImages) {
  for (const std::size_t points : {0U, 3U}) {
    const std::string bytes = binary({{along_x, "rgb/b c.jpg"}, {back, "a.jpg"}}, points);
    ASSERT_TRUE(is_colmap_images(bytes));
    const auto images = parse_colmap_images(bytes, "images.bin");
    const auto text = parse_colmap_images(
        "7 0.5 0.5 -0.5 0.5 0 0 -2 1 rgb/b c.jpg\n\n8 1 0 0 0 -1 -2 -3 1 a.jpg\n\n", "images.txt");
    ASSERT_EQ(images.size(), text.size());
    for (std::size_t i = 0; i < text.size(); ++i) {
      EXPECT_EQ(images[i].name, text[i].name);
      EXPECT_TRUE(images[i].world_from_camera.isApprox(text[i].world_from_camera, 0.0));
    }
  }
}

TEST(ColmapImages, DamagedBytesAreRefusedByTheirImage) {
  const std::string whole = binary({{along_x, "b.jpg"}, {back, "a.jpg"}}),
                    first = binary({{along_x, "b.jpg"}});
  const auto said = [](const std::string& bytes) {
    return complaint([&] { parse_colmap_images(bytes, "images.bin"); });
  };
  for (std::size_t size = first.size(); size < whole.size(); ++size)
    EXPECT_NE(said(whole.substr(0, size)).find("images.bin, image 2: expected number"), std::string::npos)
        << size;
  for (std::size_t size = 0; size < first.size(); ++size)
    EXPECT_FALSE(is_colmap_images(whole.substr(0, size))) << size;
  EXPECT_NE(said(whole + '\0').find("images.bin: expected nothing behind its 2 images"), std::string::npos);
  std::vector<double> stretched = back, unknown = back;
  stretched[0] = 2.0;
  unknown[4] = NAN;
  for (const auto& pose : {stretched, unknown})
    EXPECT_NE(said(binary({{along_x, "b.jpg"}, {pose, "a.jpg"}})).find("image 2"), std::string::npos);
  EXPECT_NE(said(binary({{along_x, "b.jpg"}, {back, ""}})).find("image 2"), std::string::npos);
  EXPECT_NE(said(binary({{along_x, "b.jpg"}, {back, std::string(5000, 'a')}})).find("image 2"),
            std::string::npos);
  std::string many = whole;  // points that are not there
  many.replace(first.size() - 3 * 24 - 8, 8, std::string(8, '\x7f'));
  EXPECT_FALSE(is_colmap_images(many));
}

}  // namespace colmap_images_test
}  // namespace clearway
