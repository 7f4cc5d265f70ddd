#include "datasets/simulation/delivered_depth.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <set>

namespace clearway {
namespace delivered_depth_test {

SceneDepth straight_way(std::size_t poses) {
  SceneDepth depth;
  depth.intrinsics = {64, 48, 60.0, 60.0, 31.5, 23.5};
  for (std::size_t i = 0; i < poses; ++i) {
    Eigen::Isometry3d pose = Eigen::Isometry3d::Identity();
    pose.translation().x() = 0.01 * static_cast<double>(i);
    depth.map_from_sensor.push_back(pose);
  }
  return depth;
}

std::vector<Surface> wall() {
  SceneShape shape{"wall", BoxShape{Eigen::Vector3d(0.2, 20, 20)}};
  shape.map_from_shape.translation().x() = 2.1;
  return {Surface(shape)};
}

double middle_range(const DepthImage& image) { return image.ranges[24 * 64 + 32]; }

TEST(DeliveredDepth, WithoutErrorsEveryPassDeliversTheTruePosesInOrder) {
  SceneDepth depth = straight_way(7);
  depth.passes = 3;
  const auto deliveries = deliver_depth(depth, 1);
  ASSERT_EQ(deliveries.size(), 21U);
  for (std::size_t i = 0; i < 21; ++i) {
    EXPECT_EQ(deliveries[i].image, i);
    EXPECT_DOUBLE_EQ(deliveries[i].time, 0.1 * static_cast<double>(i));
    EXPECT_TRUE(deliveries[i].map_from_sensor.isApprox(depth.map_from_sensor[i % 7], 1e-15));
  }
}

TEST(DeliveredDepth, AClockOffsetDeliversThePoseOfThatMuchLater) {
  SceneDepth depth = straight_way(50);
  depth.errors.clock_offset = 0.025;  // a quarter of the way to the next pose
  const auto deliveries = deliver_depth(depth, 1);
  for (std::size_t i = 0; i + 1 < deliveries.size(); ++i)
    EXPECT_NEAR(deliveries[i].map_from_sensor.translation().x(), 0.01 * (static_cast<double>(i) + 0.25),
                1e-12);
}

TEST(DeliveredDepth, DriftGrowsAsARandomWalkAndAMountErrorStays) {
  SceneDepth depth = straight_way(400);
  depth.errors.drift_shift = 0.001;
  double squares = 0.0;
  for (std::uint64_t seed = 0; seed < 40; ++seed) {
    const auto deliveries = deliver_depth(depth, seed);
    squares += (deliveries.back().map_from_sensor.translation() - depth.map_from_sensor.back().translation())
                   .squaredNorm() /
               3.0;
  }
  EXPECT_NEAR(std::sqrt(squares / 40.0), 0.001 * std::sqrt(399.0), 0.004);  // 120 draws: 6.5 % sigma

  depth.errors = {.mount_shift = 0.01};
  const auto deliveries = deliver_depth(depth, 3);
  const Eigen::Vector3d first =
      deliveries[0].map_from_sensor.translation() - depth.map_from_sensor[0].translation();
  EXPECT_GT(first.norm(), 0.002);
  for (std::size_t i = 0; i < 400; ++i) {
    const Eigen::Vector3d error =
        deliveries[i].map_from_sensor.translation() - depth.map_from_sensor[i].translation();
    EXPECT_NEAR((error - first).norm(), 0.0, 1e-12);
  }
}

TEST(DeliveredDepth, DropsAndRepeatsTheShareAskedForAndARepeatedImageHasTheNextPose) {
  SceneDepth depth = straight_way(2000);
  depth.errors.dropped = 0.2;
  depth.errors.repeated = 0.1;
  std::set<std::size_t> arrived;
  std::size_t repeated = 0;
  double last_time = -1.0;
  for (const Delivery& delivery : deliver_depth(depth, 5)) {
    arrived.insert(delivery.image);
    EXPECT_GT(delivery.time, last_time);
    last_time = delivery.time;
    if (delivery.map_from_sensor.translation().x() > 0.01 * static_cast<double>(delivery.image) + 0.005)
      ++repeated;
  }
  EXPECT_NEAR(static_cast<double>(repeated), 200.0, 60.0);
  EXPECT_NEAR(static_cast<double>(arrived.size()), 2000.0 * (1.0 - 0.2 * 0.9), 90.0);
}

TEST(DeliveredDepth, RangesAreLongerByScaleAndQuadraticErrorAndTheCameraIsTheStatedOne) {
  SceneDepth depth = straight_way(1);
  depth.unit = 1e-4;
  const auto surfaces = wall();
  const double exact = middle_range(photograph_depth(depth, 0, surfaces, 1));
  depth.errors = {.depth_scale = 0.01, .depth_quadratic = 0.002};
  const double range = middle_range(photograph_depth(depth, 0, surfaces, 1));
  EXPECT_NEAR(range, exact * 1.01 + 0.002 * exact * exact, 2.5e-4);
  depth.errors = {.focal_error = 0.02, .centre_error = 1.5};
  const DepthImage image = photograph_depth(depth, 0, surfaces, 1);
  EXPECT_DOUBLE_EQ(image.intrinsics.fx, 61.2);
  EXPECT_DOUBLE_EQ(image.intrinsics.cy, 25.0);
  EXPECT_EQ(middle_range(image), exact);
}

TEST(DeliveredDepth, MultipathOnlyLengthensByAtMostItsShare) {
  SceneDepth depth = straight_way(1);
  const auto surfaces = wall();
  depth.noise = DepthNoise{};
  const DepthImage exact = photograph_depth(depth, 0, surfaces, 4);
  depth.noise->multipath = 0.03;
  const DepthImage longer = photograph_depth(depth, 0, surfaces, 4);
  std::size_t changed = 0;
  for (std::size_t i = 0; i < exact.ranges.size(); ++i) {
    EXPECT_GE(longer.ranges[i], exact.ranges[i]);
    EXPECT_LE(longer.ranges[i], exact.ranges[i] * 1.03 + 1e-3);
    changed += longer.ranges[i] > exact.ranges[i] ? 1U : 0U;
  }
  EXPECT_GT(changed, exact.ranges.size() / 2);
}

}  // namespace delivered_depth_test
}  // namespace clearway
