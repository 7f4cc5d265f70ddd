// The voxels along a ray, against samples taken along it.

#include "mapping/maps/ray_states.hpp"

#include <gtest/gtest.h>

#include "mapping/voxels/fused_tree.hpp"
#include "tests/worlds/random_map.hpp"

namespace clearway {
namespace ray_states_test {

TEST(RayStates, AgreeWithSamplesAlongTheRay) {
  worlds::Dice dice(1);
  const Snapshot map = worlds::random_map(1, 0.05, 4, 1500).snapshot();
  int blocked = 0, through = 0;
  for (int trial = 0; trial < 400; ++trial) {
    const Eigen::Vector3d origin = dice.point(1.5);
    Eigen::Vector3d direction = dice.point(1.0);
    if (trial % 5 == 0) direction[trial / 5 % 3] = 0.0;  // along a plane of voxels
    const RayReport report = ray_states(map, origin, 3.0 * direction);
    const Eigen::Vector3d unit = direction.normalized();
    double at = 0.0;
    for (const RayRun& run : report.runs) {
      ASSERT_EQ(run.from, at);
      ASSERT_GT(run.to, run.from);
      ASSERT_NE(run.state, VoxelState::occupied);
      ASSERT_NE(run.state, VoxelState::conflict);
      for (int sample = 0; sample < 40; ++sample) {
        const double t = dice.uniform(run.from + 1e-9, run.to - 1e-9);
        if (run.to - run.from < 1e-8) break;
        ASSERT_EQ(map.state(origin + t * unit), run.state) << trial << " at " << t;
      }
      at = run.to;
    }
    ASSERT_EQ(report.distance, at);
    if (!report.blocked) {
      ++through;
      for (double t = at + 1e-9; t < 4.0; t += 0.01)
        ASSERT_EQ(map.state(origin + t * unit), VoxelState::unknown);
      continue;
    }
    ++blocked;
    EXPECT_EQ(map.state(report.blocked->center), report.blocked->state);
    const Eigen::Array3d reach = (origin + at * unit - report.blocked->center).array().abs();
    EXPECT_LE(reach.maxCoeff(), report.blocked->size / 2 + 1e-9);
  }
  EXPECT_GT(blocked, 50);
  EXPECT_GT(through, 50);
}

TEST(RayStates, StartInABlockedVoxelIsBlockedAtOnce) {
  FreeSpaceMap map({.resolution = 0.1});
  Scan scan;
  scan.points = {{0.55F, 0.05F, 0.05F}};
  map.insert(scan);
  const RayReport report = ray_states(map.snapshot(), {0.55, 0.05, 0.05}, {0.0, 0.0, 1.0});
  ASSERT_TRUE(report.blocked.has_value());
  EXPECT_EQ(report.distance, 0.0);
  EXPECT_TRUE(report.runs.empty());
}

TEST(RayStates, PassesAnEmptyMapWithoutAWord) {
  const RayReport report =
      ray_states(FreeSpaceMap({.resolution = 0.1}).snapshot(), {0, 0, 0}, {1.0, 0.0, 0.0});
  EXPECT_FALSE(report.blocked.has_value());
  EXPECT_TRUE(report.runs.empty());
}

TEST(RayStates, RefuseARayThatIsNone) {
  const Snapshot map = worlds::random_map(1).snapshot();
  EXPECT_THROW(ray_states(map, {0, 0, 0}, {0, 0, 0}), std::invalid_argument);
  EXPECT_THROW(ray_states(map, {0, 0, std::nan("")}, {0, 0, 1}), std::invalid_argument);
  EXPECT_THROW(ray_states(map, {0, 0, 0}, {0, HUGE_VAL, 1}), std::invalid_argument);
  EXPECT_THROW(ray_states(map, {1e9, 0, 0}, {0, 0, 1}), std::invalid_argument);
}

}  // namespace ray_states_test
}  // namespace clearway
