// Poses of pictures in arrays of NumPy.
#include <gtest/gtest.h>

#include "datasets/pictures/picture_poses.hpp"
#include "tests/datasets/complaint.hpp"
#include "tests/worlds/bytes/npy_bytes.hpp"
#include "tests/worlds/temporary_folder.hpp"

namespace clearway {
namespace pose_arrays_test {

namespace fs = std::filesystem;

/// Of cameras at (x, 2, 3) that look along the world's x: right is -y there, down is -z.
std::vector<double> matrix_at(double x) { return {0, 0, 1, x, -1, 0, 0, 2, 0, -1, 0, 3, 0, 0, 0, 1}; }

class PoseArrays : public testing::Test {
 protected:
  PoseArrays() {
    for (int i = 0; i < 3; ++i) pictures_.push_back("depth" + std::to_string(i) + ".png");
  }
  PicturePoses open(const std::string& bytes, bool have_times = true) {
    folder_.write("p.npy", bytes);
    return PicturePoses(folder_ / "p.npy", "", "depth", pictures_, 0.02, have_times);
  }
  /// That picture i was taken at x = i.
  void expect_places(const PicturePoses& poses) {
    ASSERT_TRUE(poses.are_there());
    for (std::size_t i = 0; i < pictures_.size(); ++i) {
      const auto pose = poses.of({pictures_[i], static_cast<double>(i)});
      ASSERT_TRUE(pose) << i;
      const Eigen::Vector3d expected(static_cast<double>(i) + 5, 1.9, 2.8);
      EXPECT_LT((*pose * Eigen::Vector3d(0.1, 0.2, 5) - expected).norm(), 1e-12) << i;
    }
    EXPECT_NE(poses.notes().at(0).find("x right, y down, z forward"), std::string::npos) << poses.notes()[0];
  }
  static std::vector<double> rows(std::initializer_list<double> places) {
    std::vector<double> all;
    for (const double x : places) {
      const std::vector<double> one = matrix_at(x);
      all.insert(all.end(), one.begin(), one.end());
    }
    return all;
  }
  TemporaryFolder folder_;
  std::vector<fs::path> pictures_;
};

TEST_F(PoseArrays, BelongToThePicturesInTheirOrder) {
  expect_places(open(npy_bytes("<f8", "(3, 4, 4)", rows({0, 1, 2}))));
  EXPECT_NE(complaint([&] {
              open(npy_bytes("<f8", "(2, 16)", rows({0, 1})));
            }).find("it has 2 poses, for 3 depth pictures"),
            std::string::npos);
  EXPECT_NE(complaint([&] {
              PicturePoses(folder_ / "p.npy", "", "depth", pictures_, 0.02, true, {}, 2.0);
            }).find("`pose_scale` is for poses of COLMAP"),
            std::string::npos);
}

TEST_F(PoseArrays, MayLieInAFileForEachPicture) {
  fs::create_directory(folder_ / "pose");
  for (int i = 0; i < 3; ++i)
    folder_.write("pose/" + std::to_string(i) + ".npy", npy_bytes("<f8", "(4, 4)", matrix_at(i)));
  const PicturePoses poses("", folder_ / "pose", "depth", pictures_, 0.02);
  expect_places(poses);
  const auto noted = [&]() {
    return !PicturePoses("", folder_ / "pose", "depth", pictures_, 0.02).notes().empty();
  };
  folder_.write("pose/readme.txt", "of somebody");
  EXPECT_TRUE(noted()) << "their axes are taken";
  for (int i = 0; i < 3; ++i)
    folder_.write("pose/" + std::to_string(i) + ".txt", "1 0 0 0 0 1 0 0 0 0 1 0 0 0 0 1\n");
  EXPECT_FALSE(noted()) << "texts count before arrays";
  for (int i = 0; i < 3; ++i) std::filesystem::remove(folder_ / "pose" / (std::to_string(i) + ".txt"));
  folder_.write("pose/1.npy", npy_bytes("<f8", "(16,)", matrix_at(1)));
  EXPECT_NE(complaint([&] {
              poses.of({pictures_[1], 1.0});
            }).find("an array of 16 entries"),
            std::string::npos);
}

TEST_F(PoseArrays, HaveTheTimesBesideThemWherePicturesHaveTimes) {
  folder_.write("times.npy", npy_bytes("<f8", "(3,)", std::vector<double>{100.0, 100.01, 100.02}));
  const std::string bytes = npy_bytes("<f8", "(3, 4, 4)", rows({0, 0.1, 0.3}));
  const PicturePoses poses = open(bytes);
  EXPECT_EQ(poses.span(), (std::pair<double, double>(100.0, 100.02)));
  EXPECT_NEAR(poses.of({pictures_[0], 100.005})->translation().x(), 0.05, 1e-4);
  EXPECT_NEAR(poses.of({pictures_[1], 100.015})->translation().x(), 0.2, 1e-4);
  EXPECT_FALSE(poses.of({pictures_[2], 101.0}));
  folder_.write("p_times.npy", "no times");
  EXPECT_NEAR(open(bytes, false).of({pictures_[2], 0.0})->translation().x(), 0.3, 1e-12);
}

}  // namespace pose_arrays_test
}  // namespace clearway
