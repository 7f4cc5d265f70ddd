#include "planning/constraint/voxel_key.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "tests/worlds/random_world.hpp"

namespace clearway {
namespace voxel_key_test {

TEST(VoxelKey, NamesItsVoxelAndAddsUpAsVoxelsDo) {
  Random random(1);
  const int most = voxel_key_bias - 200;
  const auto voxel = [&](int half) -> Eigen::Vector3i {
    return {random.below(2 * half + 1) - half, random.below(2 * half + 1) - half,
            random.below(2 * half + 1) - half};
  };
  for (int trial = 0; trial < 10000; ++trial) {
    const Eigen::Vector3i at = voxel(trial % 2 == 0 ? most : 5), step = voxel(100);
    EXPECT_NE(voxel_key(at), no_voxel);
    EXPECT_EQ(voxel_of(voxel_key(at)), at);
    EXPECT_EQ(voxel_key(at) + voxel_step(step.x(), step.y(), step.z()), voxel_key(at + step));
  }
}

TEST(VoxelKey, WholeBelowIsTheFloor) {
  for (const double value : {-2.0, -1.5, -1e-9, 0.0, 0.5, 1.0, 7.999})
    EXPECT_EQ(whole_below(value), static_cast<int>(std::floor(value)));
}

}  // namespace voxel_key_test
}  // namespace clearway
