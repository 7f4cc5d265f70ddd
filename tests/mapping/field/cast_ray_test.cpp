// Rays through blocked space against OctoMap's castRay in the same tree.

#include <gtest/gtest.h>

#include <cmath>

#include "mapping/free_space_map.hpp"
#include "mapping/voxels/fused_tree.hpp"
#include "tests/worlds/random_map.hpp"

namespace clearway {
namespace cast_ray_test {

using worlds::Dice;

constexpr double reach = 1.6;
Eigen::AlignedBox3d whole() { return {Eigen::Vector3d::Constant(-reach), Eigen::Vector3d::Constant(reach)}; }

octomap::point3d to_octomap(const Eigen::Vector3d& v) {
  return {static_cast<float>(v.x()), static_cast<float>(v.y()), static_cast<float>(v.z())};
}

FreeSpaceMap sensed_map(unsigned seed, double resolution) {
  Dice dice(seed);
  FreeSpaceMap map({.resolution = resolution});
  for (int i = 0; i < 5; ++i) map.insert(worlds::random_scan(dice, 300));
  return map;
}

/// Directions in general, along axes and along diagonals, where crossings tie.
Eigen::Vector3d random_direction(Dice& dice) {
  const int kind = dice.whole(0, 3);
  if (kind < 2) return dice.point(1.0);
  Eigen::Vector3d direction = Eigen::Vector3d::Zero();
  while (direction.isZero())
    direction = Eigen::Vector3d(dice.whole(-1, 1), dice.whole(-1, 1), dice.whole(-1, 1));
  return direction;
}

TEST(CastRay, StopsInTheVoxelWhereOctoMapsCastRayStops) {
  std::size_t hits = 0, misses = 0;
  for (unsigned seed = 0; seed < 6; ++seed) {
    Dice dice(100 + seed);
    const double resolution = dice.uniform(0.03, 0.09);
    const Snapshot map = sensed_map(seed, resolution).snapshot();
    for (const bool ignore_unknown : {true, false}) {
      const Policy policy = ignore_unknown ? Policy::not_occupied : Policy::known_free;
      const auto space = map.blocked_space({policy}, whole(), dice.uniform(0.1, 0.6));
      for (int i = 0; i < 4000; ++i) {
        Eigen::Vector3d origin = dice.point(0.7);
        if (i % 5 == 0) origin = (origin / resolution).array().round() * resolution;  // on voxel borders
        const Eigen::Vector3d direction = random_direction(dice);
        const double range = i % 3 == 0 ? 0.0 : dice.uniform(0.05, 0.8);
        octomap::point3d end;
        const double stock_range = range > 0.0 ? range : 1.5;  // beyond it lies nothing
        const bool stock =
            map.tree().castRay(to_octomap(origin), to_octomap(direction), end, ignore_unknown, stock_range);
        const RayHit hit = space->cast_ray(origin, direction, range > 0.0 ? range : stock_range);
        const bool occupied = hit.hit && map.state(hit.voxel) == VoxelState::occupied;
        ASSERT_EQ(occupied, stock) << "seed " << seed << " ray " << i;
        ++(stock ? hits : misses);
        if (!stock && !hit.hit) continue;
        ASSERT_EQ(to_octomap(hit.voxel), end) << "seed " << seed << " ray " << i;
      }
    }
  }
  EXPECT_GT(hits, 3000U);
  EXPECT_GT(misses, 3000U);
}

TEST(CastRay, LeavesTheRegionAsThePolicySays) {
  FreeSpaceMap map({.resolution = 0.1});
  map.add_volume("v", {});
  map.paint(0, {Eigen::Vector3d::Constant(0.05), 1.5});
  const Eigen::AlignedBox3d box(Eigen::Vector3d::Constant(-0.5), Eigen::Vector3d::Constant(0.5));
  const Snapshot snapshot = map.snapshot();
  const Eigen::Vector3d origin(0.01, 0.02, 0.03);
  EXPECT_FALSE(
      snapshot.blocked_space({Policy::not_occupied}, box, 0.4)->cast_ray(origin, {1, 0, 0}, 0.0).hit);
  const auto space = snapshot.blocked_space({Policy::painted}, box, 0.4);
  const double low = space->region().min().x();  // of the tree's cube that -0.5 lies in
  EXPECT_NEAR(low, -0.8, 1e-12);
  const RayHit hit = space->cast_ray(origin, {-1, 0, 0}, 0.0);
  EXPECT_TRUE(hit.hit);
  EXPECT_TRUE(hit.voxel.isApprox(Eigen::Vector3d(low - 0.05, 0.05, 0.05)));
  EXPECT_NEAR(hit.distance, (hit.voxel - origin).norm(), 1e-6);
}

TEST(CastRay, EntersTheRegionFromOutside) {
  FreeSpaceMap map({.resolution = 0.1});
  Scan scan;
  scan.points = {{0.45F, 0.05F, 0.05F}};
  map.insert(scan);
  const Eigen::AlignedBox3d box(Eigen::Vector3d::Constant(-0.5), Eigen::Vector3d::Constant(0.5));
  const auto space = map.snapshot().blocked_space({Policy::not_occupied}, box, 0.4);
  const RayHit hit = space->cast_ray({3.0, 0.05, 0.05}, {-1, 0, 0}, 0.0);
  EXPECT_TRUE(hit.hit);
  EXPECT_TRUE(hit.voxel.isApprox(Eigen::Vector3d(0.45, 0.05, 0.05)));
  EXPECT_FALSE(space->cast_ray({3.0, 0.05, 0.05}, {1, 0, 0}, 0.0).hit);
  EXPECT_FALSE(space->cast_ray({3.0, 0.05, 0.05}, {-1, 0, 0}, 2.0).hit);
}

TEST(CastRay, RefusesWhatIsNoRay) {
  const auto space = Snapshot().blocked_space({}, whole(), 3.0);
  EXPECT_THROW(space->cast_ray({0, 0, 0}, {0, 0, 0}, 0.0), std::invalid_argument);
  EXPECT_THROW(space->cast_ray({0, std::nan(""), 0}, {1, 0, 0}, 0.0), std::invalid_argument);
  EXPECT_THROW(space->cast_ray({0, 0, 0}, {HUGE_VAL, 0, 0}, 0.0), std::invalid_argument);
  EXPECT_THROW(space->cast_ray({0, 0, 0}, {1, 0, 0}, -1.0), std::invalid_argument);
  EXPECT_THROW(space->cast_ray({0, 0, 0}, {1e300, 0, 0}, 0.0), std::invalid_argument);
  EXPECT_THROW(space->cast_ray({1e300, 0, 0}, {1, 0, 0}, 0.0), std::invalid_argument);
  EXPECT_THROW(space->cast_ray({0, -1e10, 0}, {0, 1, 0}, 0.0), std::invalid_argument);
}

}  // namespace cast_ray_test
}  // namespace clearway
