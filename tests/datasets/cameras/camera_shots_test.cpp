#include "datasets/cameras/camera_shots.hpp"

#include <gtest/gtest.h>

#include "tests/datasets/complaint.hpp"

namespace clearway {
namespace camera_shots_test {

TEST(CameraPath, HasCamerasWhereAllShotsDoAndPosesWhereAnyDoes) {
  CameraPath path;
  path.shots.resize(2);
  EXPECT_FALSE(path.has_cameras());
  EXPECT_FALSE(path.has_poses());
  path.shots[0].camera = CameraIntrinsics{};
  path.shots[1].world_from_camera = Eigen::Isometry3d::Identity();
  EXPECT_FALSE(path.has_cameras());
  EXPECT_TRUE(path.has_poses());
  path.shots[1].camera = CameraIntrinsics{};
  EXPECT_TRUE(path.has_cameras());
}

TEST(RigidOf, TakesTheRowsOfAMatrixOrFailsAsTheirField) {
  const PathFields field = PathFields::parse("{}", "file 'f'");
  const std::vector<double> rows{0, -1, 0, 1, 1, 0, 0, 2, 0, 0, 1, 3};
  const Eigen::Isometry3d pose = rigid_of(rows, field, "rows");
  EXPECT_LT((pose * Eigen::Vector3d::UnitX() - Eigen::Vector3d(1, 3, 3)).norm(), 1e-12);
  for (const std::ptrdiff_t count : {0, 9, 11})
    EXPECT_EQ(
        complaint([&] { rigid_of(std::vector<double>(rows.begin(), rows.begin() + count), field, "rows"); }),
        "file 'f': expected rows");
  EXPECT_EQ(complaint([&] { rigid_of(std::vector<double>(16, 1.0), field, "rows"); }),
            "file 'f': expected rows");
}

}  // namespace camera_shots_test
}  // namespace clearway
