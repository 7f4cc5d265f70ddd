#include "datasets/poses/ned_poses.hpp"

#include <gtest/gtest.h>

#include "tests/datasets/complaint.hpp"

namespace clearway {
namespace ned_poses_test {

const std::string level = "1 2 3 0 0 0 1\n";  // looks north: x forward, y right (east), z down

TEST(NedPoses, AreThoseOfFilesThatTartanAirCallsSoWithSevenNumbers) {
  for (const char* name :
       {"pose_left.txt", "P001/pose_right.txt", "pose_lcam_front.txt", "pose_rcam_top.txt"})
    EXPECT_TRUE(is_ned_poses(name, level)) << name;
  for (const char* name : {"poses.txt", "pose_000012.txt", "pose_left.csv", "pose_.txt", "left.txt"})
    EXPECT_FALSE(is_ned_poses(name, level)) << name;
  EXPECT_FALSE(is_ned_poses("pose_left.txt", "0 1 2 3 0 0 0 1\n")) << "TUM's, with times";
  EXPECT_FALSE(is_ned_poses("pose_left.txt", ""));
}

/// By hand: a camera that looks north sees to its right what is east, below it what is down, and ahead north.
TEST(NedPoses, BecomeThoseOfTheOpticalFrameInTheSameWorld) {
  // The second turns by 90 degrees about z, down: from north to east.
  const auto numbered = parse_ned_poses(level + "0 0 0 0 0 0.70710678 0.70710678\n", "p");
  ASSERT_EQ(numbered.poses.size(), 2U);
  EXPECT_TRUE(numbered.have_numbers);
  const Eigen::Isometry3d north = numbered.poses.at(0).value(), east = numbered.poses.at(1).value();
  EXPECT_LT((north * Eigen::Vector3d(0.1, 0.2, 5) - Eigen::Vector3d(6, 2.1, 3.2)).norm(), 1e-12);
  EXPECT_LT((east * Eigen::Vector3d(0.1, 0.2, 5) - Eigen::Vector3d(-0.1, 5, 0.2)).norm(), 1e-7);
}

TEST(NedPoses, DamagedLinesAreRefusedByTheirNumber) {
  for (const char* line : {"1 2 3 0 0 0\n", "1 2 3 0 0 0 1 9\n", "1 2 3 0 0 0 x\n", "1 2 3 0 0 0 2\n",
                           "nan 2 3 0 0 0 1\n", "1 2 3 0 0 0 nan\n"}) {
    const std::string said = complaint([&] { parse_ned_poses(level + line, "poses 'p'"); });
    EXPECT_EQ(said, "poses 'p', line 2: expected 'tx ty tz qx qy qz qw' with a unit quaternion") << line;
  }
  EXPECT_TRUE(parse_ned_poses("", "p").poses.empty());
}

}  // namespace ned_poses_test
}  // namespace clearway
