#include "datasets/cameras/rigid_pose.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <tuple>

namespace clearway {
namespace rigid_pose_test {

TEST(RigidPose, HasTheRotationMadeWholeAndIsNothingElse) {
  Eigen::Matrix4d matrix = Eigen::Matrix4d::Identity();
  matrix.topRightCorner<3, 1>() << 1, 2, 3;
  matrix(0, 1) = 4e-4;   // what single precision leaves
  matrix(3, 2) = -1e-9;  // what inverting leaves
  matrix(3, 3) = 1 + 1e-7;
  const auto pose = rigid_pose(matrix);
  ASSERT_TRUE(pose);
  EXPECT_TRUE((pose->linear() * pose->linear().transpose()).isIdentity(1e-12));
  EXPECT_EQ(pose->translation(), Eigen::Vector3d(1, 2, 3));
  for (const auto& [row, column, value] :
       {std::tuple(0, 0, 1.1), {2, 2, -1.0}, {3, 0, 0.5}, {3, 1, 1e-5}, {0, 3, NAN}}) {
    Eigen::Matrix4d other = Eigen::Matrix4d::Identity();
    other(row, column) = value;
    EXPECT_FALSE(rigid_pose(other)) << other;
  }
}

}  // namespace rigid_pose_test
}  // namespace clearway
