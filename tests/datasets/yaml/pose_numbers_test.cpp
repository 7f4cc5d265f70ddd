#include "datasets/yaml/pose_numbers.hpp"

#include <gtest/gtest.h>

#include <numbers>

namespace clearway {
namespace pose_numbers_test {

constexpr double quarter = 0.5 * std::numbers::pi;

Eigen::Isometry3d pose_of(const std::vector<double>& v) {
  return Eigen::Translation3d(v[0], v[1], v[2]) * Eigen::AngleAxisd(v[5], Eigen::Vector3d::UnitZ()) *
         Eigen::AngleAxisd(v[4], Eigen::Vector3d::UnitY()) *
         Eigen::AngleAxisd(v[3], Eigen::Vector3d::UnitX());
}

TEST(PoseNumbers, MakeTheSamePoseAgainUprightOnesToo) {
  for (const double pitch :
       {0.0, 0.3, -1.2, quarter, -quarter, quarter - 1e-7, 1e-7 - quarter, quarter - 1e-10, quarter - 2e-9})
    for (const double roll : {0.0, 0.4, -2.9, quarter})
      for (const double yaw : {0.0, 0.9, -0.7, 3.1}) {
        const Eigen::Isometry3d pose = pose_of({1.0, -2.0, 0.5, roll, pitch, yaw});
        const std::vector<double> numbers = pose_numbers(pose);
        ASSERT_EQ(numbers.size(), 6U);
        EXPECT_LT((pose_of(numbers).matrix() - pose.matrix()).norm(), 2e-8)
            << roll << " " << pitch << " " << yaw;
      }
}

TEST(PoseNumbers, GiveAllOfAnUprightTurnToTheYaw) {
  const std::vector<double> up = pose_numbers(pose_of({0, 0, 0, 0.0, quarter, 0.7}));
  EXPECT_EQ(up[3], 0.0);
  EXPECT_NEAR(up[4], quarter, 1e-9);
  EXPECT_NEAR(up[5], 0.7, 1e-12);
  EXPECT_NEAR(pose_numbers(pose_of({0, 0, 0, 0.4, quarter, 0.9}))[5], 0.5, 1e-12);
  EXPECT_NEAR(pose_numbers(pose_of({0, 0, 0, 0.4, -quarter, 0.9}))[5], 1.3, 1e-12);
}

}  // namespace pose_numbers_test
}  // namespace clearway
