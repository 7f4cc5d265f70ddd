#include "datasets/cameras/colmap_images.hpp"

#include <gtest/gtest.h>

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

}  // namespace colmap_images_test
}  // namespace clearway
