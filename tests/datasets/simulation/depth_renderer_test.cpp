#include "datasets/simulation/depth_renderer.hpp"

#include <gtest/gtest.h>

namespace clearway {
namespace depth_renderer_test {

SceneDepth sensor_at(const Eigen::Isometry3d& pose) {
  SceneDepth depth;
  depth.intrinsics = {80, 60, 70, 71, 40, 29, {}};
  depth.map_from_sensor = {pose};
  return depth;
}

/// The ray of a pixel in the sensor frame, written out.
Eigen::Vector3d ray(const CameraIntrinsics& camera, int column, int row) {
  return Eigen::Vector3d(1, -(column - camera.cx) / camera.fx, -(row - camera.cy) / camera.fy).normalized();
}

TEST(DepthRenderer, APlaneIsAsFarAsGeometrySays) {
  Eigen::Isometry3d pose(Eigen::Translation3d(0.3, -0.2, 1.5));
  pose.rotate(Eigen::AngleAxisd(0.9, Eigen::Vector3d(0.2, 1, 0.1).normalized()));
  const auto depth = sensor_at(pose);
  const Surface floor(
      SceneShape{"floor", BoxShape{{100, 100, 1}}, Eigen::Isometry3d(Eigen::Translation3d(0, 0, -0.5))});
  const auto image = render_depth(depth, 0, std::vector<Surface>{floor}, 1);
  int seen = 0;
  for (int row = 0; row < 60; ++row)
    for (int column = 0; column < 80; ++column) {
      const Eigen::Vector3d direction = pose.linear() * ray(depth.intrinsics, column, row);
      const double expected = direction.z() < 0 ? -1.5 / direction.z() : INFINITY;
      const float range = image.ranges[static_cast<size_t>(80 * row + column)];
      if (expected > depth.max_range) {
        EXPECT_EQ(range, 0);
      } else {
        EXPECT_NEAR(range, expected, 1e-6);
        ++seen;
      }
    }
  EXPECT_GT(seen, 1000);
}

TEST(DepthRenderer, ABallIsAsFarAsTheQuadraticFormulaSays) {
  const auto depth = sensor_at(Eigen::Isometry3d::Identity());
  const Eigen::Vector3d center(2, 0.1, -0.2);
  const Surface ball(SceneShape{"ball", SphereShape{0.4}, Eigen::Isometry3d(Eigen::Translation3d(center))});
  const auto image = render_depth(depth, 0, std::vector<Surface>{ball}, 1);
  for (int row = 0; row < 60; ++row)
    for (int column = 0; column < 80; ++column) {
      const Eigen::Vector3d direction = ray(depth.intrinsics, column, row);
      const double closest = center.dot(direction), passing = (center - closest * direction).norm();
      const double expected = passing < 0.4 ? closest - std::sqrt(0.16 - passing * passing) : 0;
      EXPECT_NEAR(image.ranges[static_cast<size_t>(80 * row + column)], expected, 1e-5);
    }
}

TEST(DepthRenderer, NoiseGrowsWithTheSquareOfTheRangeAndSomePixelsDropOut) {
  auto depth = sensor_at(Eigen::Isometry3d::Identity());
  depth.intrinsics = {200, 200, 4000, 4000, 100, 100, {}};  // nearly parallel rays
  depth.noise_constant = 0.001;
  depth.noise_quadratic = 0.002;
  depth.dropout = 0.1;
  for (double range : {1.0, 3.0}) {
    const Surface wall(SceneShape{"wall", BoxShape{{1, 10, 10}},
                                  Eigen::Isometry3d(Eigen::Translation3d(range + 0.5, 0, 0))});
    const auto image = render_depth(depth, 0, std::vector<Surface>{wall}, 1);
    double squares = 0, count = 0;
    for (int row = 0; row < 200; ++row)
      for (int column = 0; column < 200; ++column) {
        const float measured = image.ranges[static_cast<size_t>(200 * row + column)];
        if (measured == 0) continue;
        const double error = measured - range / ray(depth.intrinsics, column, row).x();
        squares += error * error;
        ++count;
      }
    EXPECT_NEAR(count / 40000, 0.9, 0.01);
    const double sigma = 0.001 + 0.002 * range * range;
    EXPECT_NEAR(std::sqrt(squares / count), sigma, 0.03 * sigma);
  }
}

TEST(CountWholeSteps, puts_every_range_at_most_one_step_before_the_surface_and_never_behind) {
  DepthImage image;
  image.unit = 5e-5;
  for (int i = 0; i < 20000; ++i) image.ranges.push_back(static_cast<float>(0.05 + 3.7e-5 * i));
  image.ranges.push_back(0);
  const std::vector<float> exact = image.ranges;
  count_whole_steps(image);
  for (size_t i = 0; i + 1 < exact.size(); ++i) {
    EXPECT_LT(image.ranges[i], exact[i]);
    EXPECT_GT(image.ranges[i], exact[i] - 1.002 * image.unit);
    const double steps = image.ranges[i] / image.unit;
    EXPECT_NEAR(steps, std::round(steps), 1e-2);
  }
  EXPECT_EQ(image.ranges.back(), 0.0f);
}

}  // namespace depth_renderer_test
}  // namespace clearway
