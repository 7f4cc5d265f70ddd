// TartanAir's folders: known walls, on the sides where they have to land.
#include <gtest/gtest.h>

#include <cstring>

#include "datasets/pictures/depth_picture.hpp"
#include "tests/datasets/complaint.hpp"
#include "tests/datasets/pictures/depth_folders.hpp"
#include "tests/worlds/bytes/npy_bytes.hpp"

namespace clearway {
namespace tartanair_test {

using namespace depth_folders;

/// A wall 4 m ahead, nearer in the last row and in the last column, and sky in the first row.
std::vector<float> seen() {
  std::vector<float> depth(36 * 48, 4.0F);
  for (std::size_t row = 0; row < 36; ++row) depth[row * 48 + 47] = 2.0F;
  for (std::size_t column = 0; column < 48; ++column) {
    depth[column] = column % 2 == 0 ? 10000.0F : 1000.0F;
    depth[35 * 48 + column] = 1.0F;
  }
  return depth;
}

/// As TartanAir V2 writes it: the bytes of a real number are a pixel's blue, green, red and alpha.
std::string packed_png(const std::vector<float>& depth) {
  cv::Mat pixels(36, 48, CV_8UC4);
  std::memcpy(pixels.data, depth.data(), depth.size() * sizeof(float));
  return picture_bytes(pixels, ".png");
}

class TartanAir : public DepthFolders {
 protected:
  /// Where what is seen in this pixel of each picture lies, with north ahead of the first picture, which is
  /// at the place (1, 2, 3), east ahead of the second.
  static Eigen::Vector3d place_of(const CloudFrame& cloud, std::size_t row, std::size_t column) {
    return cloud.world_from_sensor * cloud.points.at((row - 1) * 48 + column).cast<double>();  // without sky
  }
  void expect_walls(FrameSource& source) {
    const auto first = source.next(), second = source.next();
    ASSERT_TRUE(first && second);
    EXPECT_FALSE(source.next());
    const auto& cloud = std::get<CloudFrame>(first->content);
    ASSERT_EQ(cloud.points.size(), 35U * 48U);
    // f = 50 and 52, from (24, 18): x is north, y east, z down.
    const Eigen::Vector3d ahead(5, 2, 3), right(3, 2 + 2.0 * 23 / 50, 3), below(2, 2, 3 + 17.0 / 52);
    EXPECT_LT((place_of(cloud, 18, 24) - ahead).norm(), 1e-5) << place_of(cloud, 18, 24);
    EXPECT_LT((place_of(cloud, 18, 47) - right).norm(), 1e-5) << place_of(cloud, 18, 47);
    EXPECT_LT((place_of(cloud, 35, 24) - below).norm(), 1e-5) << place_of(cloud, 35, 24);
    const auto& turned = std::get<CloudFrame>(second->content);
    EXPECT_LT((place_of(turned, 18, 24) - Eigen::Vector3d(0, 4, 0)).norm(), 1e-5);
    EXPECT_LT((place_of(turned, 18, 47) - Eigen::Vector3d(-2.0 * 23 / 50, 2, 0)).norm(), 1e-5);
    told_.clear();
    for (const std::string& warning : source.warnings()) told_ += warning + '\n';
  }
  static SourceOptions with_camera() {
    SourceOptions with;
    with.camera = camera;
    return with;
  }
  std::string told_;
};

constexpr char poses[] = "1 2 3 0 0 0 1\n0 0 0 0 0 0.7071067811865476 0.7071067811865476\n";

TEST_F(TartanAir, OfTheFirstVersionLandsNorthEastAndDown) {
  for (const char* name : {"depth_left", "image_left", "depth_right"}) make(name);
  for (const char* number : {"000000", "000001"}) {
    const std::string name(number);
    const std::string depth = npy_bytes("<f4", "(36, 48)", seen());
    folder_.write("depth_left/" + name + "_left_depth.npy", depth);
    folder_.write("depth_right/" + name + "_right_depth.npy", depth);
  }
  folder_.write("pose_left.txt", poses);
  folder_.write("pose_right.txt", "0 0 9 0 0 0 1\n0 0 9 0 0 0 1\n");
  expect_walls(*open(with_camera()));
  for (const char* said :
       {"1000 m or more", "x forward, y right and z down", "those of 'depth_right' beside it"})
    EXPECT_NE(told_.find(said), std::string::npos) << said << '\n' << told_;
  EXPECT_EQ(told_.find("nothing states"), std::string::npos) << told_;
  // What the setup states has no sky.
  SourceOptions stated = with_camera();
  stated.depth.scale = 1.0;
  const auto whole = open(stated)->next();
  ASSERT_TRUE(whole);
  EXPECT_EQ(std::get<CloudFrame>(whole->content).points.size(), 35U * 48U + 24U);
  // Of fewer pictures each has the pose of its number.
  std::filesystem::remove(folder_ / "depth_left/000000_left_depth.npy");
  folder_.write("depth_left/000001_left_depth.npy", npy_bytes("<f4", "(36, 48)", seen()));
  folder_.write("pose_left.txt", "9 9 9 0 0 0 1\n1 2 3 0 0 0 1\n8 8 8 0 0 0 1\n");
  const auto frame = open(with_camera())->next();
  ASSERT_TRUE(frame);
  EXPECT_EQ(std::get<CloudFrame>(frame->content).world_from_sensor.translation(), Eigen::Vector3d(1, 2, 3));
}

TEST_F(TartanAir, OfTheSecondVersionHasItsNumbersInColoursAndAlpha) {
  for (const char* name : {"depth_lcam_front", "image_lcam_front"}) make(name);
  for (const char* number : {"000000", "000001"})
    folder_.write("depth_lcam_front/" + std::string(number) + "_lcam_front_depth.png", packed_png(seen()));
  folder_.write("pose_lcam_front.txt", poses);
  expect_walls(*open(with_camera()));
  EXPECT_NE(told_.find("1000 m or more"), std::string::npos) << told_;
}

TEST_F(TartanAir, PosesOfAnotherLengthAreRefused) {
  make("depth_left");
  folder_.write("depth_left/000000_left_depth.npy", npy_bytes("<f4", "(36, 48)", seen()));
  EXPECT_NE(complaint([&] { open(with_camera()); }).find("has no poses"), std::string::npos);
  folder_.write("pose_left.txt", "1 2 3 0 0 0 1\n1 2 3 0 0 0\n");
  EXPECT_NE(complaint([&] { open(with_camera()); }).find("line 2: expected 'tx ty tz qx qy qz qw'"),
            std::string::npos);
}

/// A picture to look at holds no numbers that a sensor sees: its alpha would be their sign and exponent.
TEST(PackedDepth, IsNoPictureThatIsOpaqueOrClear) {
  EXPECT_EQ(decode_depth_picture(packed_png(seen())).values[48], 4.0F);
  EXPECT_TRUE(decode_depth_picture(packed_png(seen())).is_real);
  std::vector<float> open_sky = seen();
  open_sky[7] = INFINITY;
  EXPECT_EQ(decode_depth_picture(packed_png(open_sky)).values[48], 4.0F);
  for (const cv::Scalar& pixel :
       {cv::Scalar(90, 80, 70, 255), cv::Scalar(90, 80, 70, 0), cv::Scalar(0, 0, 0, 0)})
    EXPECT_NE(complaint<std::runtime_error>([&] {
                decode_depth_picture(picture_bytes(cv::Mat(36, 48, CV_8UC4, pixel), ".png"));
              }).find("not a grey picture"),
              std::string::npos)
        << pixel;
}

}  // namespace tartanair_test
}  // namespace clearway
