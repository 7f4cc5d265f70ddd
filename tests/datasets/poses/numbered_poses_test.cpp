#include "datasets/poses/numbered_poses.hpp"

#include <gtest/gtest.h>

#include "tests/datasets/complaint.hpp"

namespace clearway {
namespace numbered_poses_test {

TEST(PoseMatrix, IsRigidOrRefusedOrUnknown) {
  EXPECT_FALSE(parse_pose_matrix("nan nan nan nan 0 1 0 0 0 0 1 0 0 0 0 1", "m"));
  const auto turned = parse_pose_matrix("0 -1 0 1  1 0 0 2  0 0 1 3  0 0 0 1\n", "m");
  EXPECT_LT((*turned * Eigen::Vector3d::UnitX() - Eigen::Vector3d(1, 3, 3)).norm(), 1e-12);
  const auto rows = parse_pose_matrix("0 -1 0 1\n1 0 0 2\n0 0 1 3\n", "m");
  EXPECT_TRUE(rows->isApprox(*turned)) << "the last row says nothing";
  for (const char* wrong :
       {"", "1 0 0 0 0 1 0 0 0 0 1 0 0 0 0 1 7", "1 0 0 0 0 1 0 0 0 0 1", "x", "1 0 0 0 0 1 0 0 0 0 -1 0",
        "1 0 0 0 0 1 0 0 0 0 -1 0 0 0 0 1", "1 0 0 0 0 1 0 0 0 0 1 0 0 0 1 1"})
    EXPECT_NE(complaint([&] { parse_pose_matrix(wrong, "pose 'm'"); }).find("pose 'm': expected four rows"),
              std::string::npos)
        << wrong;
}

/// The other forms stand in picture_poses_test.cpp, each against the same poses.
TEST(NumberedPosesOfText, AreOfTheFirstLinesKind) {
  EXPECT_EQ(parse_numbered_poses("1 0 0 1 0 1 0 2 0 0 1 3\n", "p")->poses.size(), 1U);
  EXPECT_FALSE(parse_numbered_poses("0 1 2 3 0 0 0 1\n", "p"));
  EXPECT_FALSE(parse_numbered_poses("", "p"));
  EXPECT_NE(complaint([] {
              parse_numbered_poses("1 0 0 1 0 1 0 2 0 0 1 3\n1 2\n", "p");
            }).find("p, line 2: expected 12 numbers"),
            std::string::npos);
}

}  // namespace numbered_poses_test
}  // namespace clearway
