// Figures of painted volumes whose truth is known.

#include "mapping/volumes/volume_quality.hpp"

#include <gtest/gtest.h>

#include <numbers>

#include "tests/worlds/random_map.hpp"

namespace clearway {
namespace volume_quality_test {

using worlds::Dice;

FreeSpaceMap painted_map(double resolution, const std::vector<Sphere>& spheres) {
  FreeSpaceMap map({.resolution = resolution});
  map.add_volume("v", {"tool"});
  for (const Sphere& sphere : spheres) map.paint(0, sphere);
  return map;
}

/// A curved stroke of spheres of 5 cm, 1 cm apart.
std::vector<Sphere> stroke() {
  std::vector<Sphere> spheres;
  for (int i = 0; i < 60; ++i) {
    const double t = 0.03 * i;
    spheres.push_back({{0.3 * std::cos(t), 0.3 * std::sin(t), 0.1 * t}, 0.05});
  }
  return spheres;
}

/// Spheres on a sphere of radius 0.3 about `center`, so near one another that they enclose its inside.
std::vector<Sphere> shell(const Eigen::Vector3d& center) {
  std::vector<Sphere> spheres;
  constexpr int count = 400;
  for (int i = 0; i < count; ++i) {  // Fibonacci's spiral
    const double z = 1.0 - (2.0 * i + 1.0) / count;
    const double turn = i * std::numbers::pi * (3.0 - std::sqrt(5.0));
    const double across = std::sqrt(1.0 - z * z);
    spheres.push_back(
        {center + 0.3 * Eigen::Vector3d(across * std::cos(turn), across * std::sin(turn), z), 0.1});
  }
  return spheres;
}

TEST(VolumeQuality, TheVoxelsAreLessThanTheExactVolumeAndTheLossHalvesWithTheResolution) {
  double coarser = 0.0;
  for (const double resolution : {0.02, 0.01, 0.005, 0.0025}) {
    const Snapshot map = painted_map(resolution, stroke()).snapshot();
    const VolumeQuality quality = measure_volume(map, 0);
    EXPECT_LT(quality.voxel_volume, quality.exact.lower);
    EXPECT_NEAR(quality.voxel_volume, static_cast<double>(map.counts().painted) * std::pow(resolution, 3),
                1e-12);
    if (resolution < 0.01) {
      EXPECT_GT(coarser / quality.loss(), 1.7);
      EXPECT_LT(coarser / quality.loss(), 2.3);
    }
    coarser = quality.loss();
  }
}

TEST(VolumeQuality, ASphereIsItsOwnMostCompactShape) {
  const VolumeQuality sphere = measure_volume(painted_map(0.01, {{{0.1, 0.2, 0.3}, 0.1}}).snapshot(), 0);
  EXPECT_NEAR(sphere.sphericity(), 1.0, 2e-3);
  EXPECT_NEAR(sphere.surface.area, 4 * std::numbers::pi * 0.01, 1e-6);
  EXPECT_EQ(sphere.parts.size(), 1U);
  EXPECT_TRUE(sphere.holes.empty());
  EXPECT_TRUE(sphere.necks.empty());
  EXPECT_LT(measure_volume(painted_map(0.01, stroke()).snapshot(), 0).sphericity(), 0.7);
}

TEST(VolumeQuality, TheInsideOfAShellIsAHoleWithItsPlaceAndSize) {
  const Eigen::Vector3d center(0.05, -0.1, 0.2);
  const Snapshot map = painted_map(0.02, shell(center)).snapshot();
  const VolumeQuality quality = measure_volume(map, 0);
  ASSERT_EQ(quality.holes.size(), 1U);
  const VolumeHole& hole = quality.holes[0];
  EXPECT_LT((hole.centroid - center).norm(), 0.01);
  EXPECT_EQ(map.state(hole.inside), VoxelState::unknown);
  EXPECT_GT(hole.beyond_spheres, 0U);
  EXPECT_LT(hole.beyond_spheres, hole.voxels);
  EXPECT_EQ(hole.occupied, 0U);
  // The pocket between the spheres is about a sphere of 0.2 m; the voxels add about one resolution all
  // around.
  EXPECT_GT(hole.volume, 4.0 / 3.0 * std::numbers::pi * std::pow(0.2, 3));
  EXPECT_LT(hole.volume, 4.0 / 3.0 * std::numbers::pi * std::pow(0.24, 3));
}

TEST(VolumeQuality, AnOccupiedVoxelInsideAVolumeIsAHoleThatSaysSo) {
  FreeSpaceMap map = painted_map(0.05, {{{0.0, 0.0, 0.0}, 0.5}});
  Scan scan;
  scan.points = {{0.12F, 0.02F, 0.02F}};
  map.insert(scan);
  const VolumeQuality quality = measure_volume(map.snapshot(), 0);
  EXPECT_EQ(quality.occupied, 1U);
  ASSERT_EQ(quality.holes.size(), 1U);
  EXPECT_EQ(quality.holes[0].voxels, 1U);
  EXPECT_EQ(quality.holes[0].occupied, 1U);
  EXPECT_EQ(quality.holes[0].beyond_spheres, 0U);
  EXPECT_TRUE(quality.holes[0].inside.isApprox(Eigen::Vector3d(0.125, 0.025, 0.025)));
}

TEST(VolumeQuality, AHoleThatOnlyTheVoxelsHaveClosesOnAFinerMap) {
  // Four spheres whose common meeting point no single sphere holds with a whole voxel of 4 cm around it.
  std::vector<Sphere> spheres;
  for (const double x : {-0.1, 0.1}) {
    for (const double y : {-0.1, 0.1}) {
      for (const double z : {-0.1, 0.1}) spheres.push_back({{x + 0.02, y + 0.02, z + 0.02}, 0.19});
    }
  }
  const VolumeQuality coarse = measure_volume(painted_map(0.04, spheres).snapshot(), 0);
  ASSERT_EQ(coarse.holes.size(), 1U);
  EXPECT_EQ(coarse.holes[0].beyond_spheres, 0U);
  EXPECT_TRUE(measure_volume(painted_map(0.01, spheres).snapshot(), 0).holes.empty());
}

TEST(VolumeQuality, TheNeckBetweenTwoSpheresIsTheCircleInWhichTheyMeet) {
  Dice dice(3);
  for (int trial = 0; trial < 10; ++trial) {
    const double resolution = 0.005, r = dice.uniform(0.08, 0.12), d = dice.uniform(1.4, 1.7) * r;
    const Eigen::Vector3d at = dice.point(0.2), towards = dice.point(1.0).normalized();
    const VolumeQuality quality =
        measure_volume(painted_map(resolution, {{at, r}, {at + d * towards, r}}).snapshot(), 0);
    const double truth = std::sqrt(r * r - d * d / 4);
    // A sphere's voxels hold all of the sphere that is smaller by a voxel's diagonal.
    const double less = r - std::sqrt(3.0) * resolution;
    ASSERT_EQ(quality.necks.size(), 1U);
    const VolumeNeck& neck = quality.necks[0];
    EXPECT_LE(neck.radius - resolution / 2, truth);
    EXPECT_GE(neck.radius, std::sqrt(less * less - d * d / 4) - resolution);
    EXPECT_LT((neck.position - at - d / 2 * towards).norm(), 3 * resolution);
    EXPECT_LE(neck.larger, r);
    EXPECT_GT(neck.smaller, less - resolution);
  }
}

TEST(VolumeQuality, ASmoothStrokeHasNoNeckAndASparseOneHasThemBetweenItsSpheres) {
  EXPECT_TRUE(measure_volume(painted_map(0.005, stroke()).snapshot(), 0).necks.empty());
  std::vector<Sphere> sparse;
  for (int i = 0; i < 5; ++i) sparse.push_back({{0.15 * i, 0.01, 0.02}, 0.09});
  const VolumeQuality quality = measure_volume(painted_map(0.005, sparse).snapshot(), 0);
  EXPECT_EQ(quality.necks.size(), 4U);
  EXPECT_EQ(quality.parts.size(), 1U);
  for (std::size_t i = 1; i < quality.necks.size(); ++i) {
    EXPECT_GE(quality.necks[i].radius, quality.necks[i - 1].radius);
  }
}

TEST(VolumeQuality, SpheresThatDoNotMeetAreParts) {
  const VolumeQuality quality =
      measure_volume(painted_map(0.02, {{{0, 0, 0}, 0.2}, {{0.6, 0, 0}, 0.3}}).snapshot(), 0);
  EXPECT_EQ(quality.parts.size(), 2U);
  EXPECT_EQ(quality.parts[0] + quality.parts[1], quality.voxels);
  EXPECT_EQ(quality.spacing.thin.size(), 1U);
}

TEST(VolumeQuality, SaysWhyAVolumeIsTooLargeToSearch) {
  const VolumeQuality quality =
      measure_volume(painted_map(0.02, {{{0, 0, 0}, 0.2}}).snapshot(), 0, {.most_cells = 1000});
  EXPECT_NE(quality.not_searched.find("million voxels"), std::string::npos);
  EXPECT_TRUE(quality.parts.empty());
  EXPECT_GT(quality.exact.lower, 0.0);
}

TEST(VolumeQuality, OfAnEmptyVolumeIsZeroAndOfNoneIsRefused) {
  const Snapshot map = painted_map(0.02, {}).snapshot();
  const VolumeQuality quality = measure_volume(map, 0);
  EXPECT_EQ(quality.label, "v");
  EXPECT_EQ(quality.voxels, 0U);
  EXPECT_EQ(quality.exact.upper, 0.0);
  EXPECT_EQ(quality.sphericity(), 0.0);
  EXPECT_THROW(measure_volume(map, -1), std::invalid_argument);
  EXPECT_THROW(measure_volume(map, 15), std::invalid_argument);
  EXPECT_THROW(measure_volume(map, 0, {.neck_ratio = 1.0}), std::invalid_argument);
}

}  // namespace volume_quality_test
}  // namespace clearway
