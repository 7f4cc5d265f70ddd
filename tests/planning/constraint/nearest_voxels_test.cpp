#include "planning/constraint/nearest_voxels.hpp"

#include <gtest/gtest.h>

#include "tests/worlds/random_world.hpp"

namespace clearway {
namespace nearest_cubes_test {

constexpr double edge = 0.05;

double distance_to(const Eigen::Vector3d& cube, const Eigen::Vector3d& point) {
  return ((point - cube).cwiseAbs().array() - edge / 2).max(0.0).matrix().norm();
}

Eigen::Vector3d middle_of(VoxelKey voxel) { return (voxel_of(voxel).cast<double>().array() + 0.5) * edge; }

TEST(NearestVoxels, AreBlockedAndAsNearAsTheSearchFinds) {
  for (const Policy policy : {Policy::not_occupied, Policy::known_free}) {
    Random random(5);
    FreeSpaceMap map({.resolution = edge});
    for (int i = 0; i < 40; ++i) occupy(map, ((random.point(0.5) / edge).array().floor() + 0.5) * edge);
    map.paint(map.add_volume("free", {}), {Eigen::Vector3d(0.1, 0.0, 0.0), 0.45});
    const auto space = map.snapshot().blocked_space(
        Requirement{policy}, {Eigen::Vector3d::Constant(-0.8), Eigen::Vector3d::Constant(0.8)}, 0.3);
    NearestVoxels cubes(*space);
    int near = 0;
    for (int i = 0; i < 20000; ++i) {
      std::array<VoxelKey, 3> voxels, found, again;
      for (VoxelKey& voxel : voxels)
        voxel = voxel_key((random.point(0.9) / edge).array().floor().matrix().cast<int>());
      cubes.look_up(voxels, found);
      cubes.look_up(voxels, again);
      EXPECT_EQ(found, again);
      const Eigen::Vector3d middle = middle_of(voxels[1]);
      const NearestBlocked truth = space->nearest(middle, space->max_distance());
      const bool is_near = found[1] != no_voxel;
      ASSERT_TRUE(is_near || !truth.found || truth.distance > space->max_distance() - 1e-6);
      if (!is_near) continue;
      ++near;
      const Eigen::Vector3d cube = middle_of(found[1]);
      EXPECT_TRUE(space->is_blocked(cube));
      if (!truth.found) continue;
      EXPECT_NEAR(distance_to(cube, middle), truth.distance, 1e-6);
    }
    EXPECT_GT(near, 3000);
    EXPECT_LT(cubes.searched(), cubes.looked_up() / 2);
  }
}

}  // namespace nearest_cubes_test
}  // namespace clearway
