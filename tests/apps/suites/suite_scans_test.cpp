#include "apps/suites/suite_scans.hpp"

#include <gtest/gtest.h>

#include <random>

#include "mapping/continued_map.hpp"
#include "mapping/system/random_unit.hpp"

namespace clearway {
namespace suite_scans_test {

constexpr double resolution = 0.05, range = 0.5;

std::vector<Eigen::Vector3d> clutter(std::mt19937_64& random, double share) {
  std::vector<Eigen::Vector3d> voxels;
  for (int x = -11; x <= 11; ++x) {
    for (int y = -11; y <= 11; ++y) {
      for (int z = -11; z <= 11; ++z) {
        const bool is_near_sensor = std::max({std::abs(x), std::abs(y), std::abs(z)}) < 2;
        if (!is_near_sensor && random_unit(random) < share)
          voxels.emplace_back(Eigen::Vector3d(x + 0.5, y + 0.5, z + 0.5) * resolution);
      }
    }
  }
  return voxels;
}

/// Occupied in one scan each, taken within the voxel, so that no ray frees another.
Snapshot map_of(const std::vector<Eigen::Vector3d>& voxels) {
  FreeSpaceMap map({.resolution = resolution});
  for (const Eigen::Vector3d& voxel : voxels) {
    Scan scan;
    scan.map_from_sensor.translation() = voxel;
    scan.points = {Eigen::Vector3f(0.001F, 0.0F, 0.0F)};
    for (int i = 0; i < 3; ++i) map.insert(scan);
  }
  return map.snapshot();
}

bool is_occupied(const Snapshot& map, const Eigen::Vector3d& voxel) {
  return !allows({Policy::not_occupied}, map.state(voxel), 0);
}

TEST(SuiteScans, NoVoxelThatStandsStillIsFreedHoweverOftenItIsLookedAt) {
  std::mt19937_64 random(5);
  for (const Eigen::Vector3d& sensor :
       {Eigen::Vector3d(0.011, 0.023, 0.017), Eigen::Vector3d(0.0, 0.0, 0.025)}) {
    const Eigen::AlignedBox3d near(Eigen::Vector3d::Constant(-1.0), Eigen::Vector3d::Constant(1.0));
    for (const double share : {0.01, 0.05, 0.1}) {
      for (int round = 0; round < 3; ++round) {
        const std::vector<Eigen::Vector3d> voxels = clutter(random, share);
        const Snapshot start = map_of(voxels);
        const auto occupied = start.blocked_space({Policy::not_occupied}, near, resolution);
        const Scan still = scan_voxels(*occupied, sensor, range, resolution);
        SceneShape ball;  // that stands before some of them
        ball.geometry = SphereShape{0.08};
        ball.map_from_shape.translation() = Eigen::Vector3d(0.25, -0.1, 0.05);
        const Scan before = scan_solids_before(still, {ball}, *occupied, range, resolution).scan;
        ContinuedMap map(start, {.hit_probability = 0.9, .integration = Integration::compatible});
        for (int look = 0; look < 15; ++look)
          map.insert(look % 3 == 2 ? before : still, {.max_range = range});
        int freed = 0;
        for (const Eigen::Vector3d& voxel : voxels)
          freed += (voxel - sensor).norm() <= range && !is_occupied(map.snapshot(), voxel);
        EXPECT_EQ(freed, 0) << share << " of " << voxels.size();
        EXPECT_GT(still.points.size(), 100U);
      }
    }
  }
}

}  // namespace suite_scans_test
}  // namespace clearway
