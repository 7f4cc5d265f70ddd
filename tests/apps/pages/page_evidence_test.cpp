// What a page knows of voxels beside their states, against the map voxel by voxel.

#include "apps/pages/page_evidence.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <limits>

#include "mapping/stamps/seen_stamps.hpp"
#include "tests/worlds/random_map.hpp"

namespace clearway {
namespace page_evidence_test {

/// Of one cube, from its voxels.
struct Cube {
  double newest = -1.0;  ///< look; below 0: none
  unsigned volumes = 0;  ///< mask
  bool observed = false;
  double least = std::numeric_limits<double>::infinity(), greatest = -least;
};

Cube cube_of(const Snapshot& map, const Eigen::Vector3i& low, int cell) {
  Cube cube;
  for (int x = 0; x < cell; ++x)
    for (int y = 0; y < cell; ++y)
      for (int z = 0; z < cell; ++z) {
        const Eigen::Vector3d middle =
            (low + Eigen::Vector3i(x, y, z)).cast<double>().array() * map.resolution() +
            0.5 * map.resolution();
        const Voxel voxel = map.voxel(middle);
        cube.volumes |= voxel.volumes;
        if (!voxel.observed) continue;
        cube.observed = true;
        cube.least = std::min(cube.least, voxel.log_odds);
        cube.greatest = std::max(cube.greatest, voxel.log_odds);
        if (const auto time = map.last_seen(middle)) cube.newest = std::max(cube.newest, *time);
      }
  return cube;
}

PageEvidence evidence_of(const MapLeaves& map) {
  EvidenceGrid grid(map);
  map.visit([&](const MapLeaf& leaf) { grid.add(leaf); });
  return grid.take();
}

double value_of(std::uint8_t step, double from, double to) { return from + (step - 1) / 254.0 * (to - from); }

TEST(PageEvidence, IsThatOfTheVoxelsInEachCube) {
  for (unsigned seed = 1; seed < 4; ++seed) {
    FreeSpaceMap made = worlds::random_map(seed);
    worlds::Dice dice(seed);
    for (const double time : {20.0, 50.0}) {
      Scan scan = worlds::random_scan(dice, 300);
      scan.time = time;
      made.insert(scan);
    }
    const Snapshot map = made.snapshot();
    const PageEvidence grid = evidence_of(MapLeaves(map));
    ASSERT_LE(grid.size.cast<double>().prod(), static_cast<double>(PageEvidence::most_cells));
    ASSERT_EQ(grid.look.size(), static_cast<std::size_t>(grid.size.prod()));
    const double odds_step = (grid.greatest - grid.least) / 254.0,
                 look_step = (grid.newest - grid.oldest) / 254.0;
    int observed = 0, painted = 0, seen = 0;
    for (int i = 0; i < grid.size.prod(); ++i) {
      const Eigen::Vector3i at(i % grid.size.x(), i / grid.size.x() % grid.size.y(),
                               i / grid.size.x() / grid.size.y());
      const auto k = static_cast<std::size_t>(i);
      const Cube cube = cube_of(map, grid.low + grid.cell * at, grid.cell);
      const int volumes = __builtin_popcount(cube.volumes);
      painted += volumes > 0;
      ASSERT_EQ(grid.volume[k], volumes == 0 ? 0 : volumes > 1 ? 255 : __builtin_ctz(cube.volumes) + 1);
      ASSERT_EQ(grid.high_odds[k] > 0, cube.observed);
      ASSERT_EQ(grid.low_odds[k] > 0, cube.observed);
      if (!cube.observed) continue;
      ++observed;
      ASSERT_NEAR(value_of(grid.low_odds[k], grid.least, grid.greatest), cube.least, 0.51 * odds_step + 1e-6);
      ASSERT_NEAR(value_of(grid.high_odds[k], grid.least, grid.greatest), cube.greatest,
                  0.51 * odds_step + 1e-6);
      if (grid.look[k] > 0) ++seen;
      if (grid.cell == 1) {
        ASSERT_EQ(grid.look[k] > 0, cube.newest >= 0.0);
        if (cube.newest >= 0.0) {
          ASSERT_NEAR(value_of(grid.look[k], grid.oldest, grid.newest), cube.newest, 0.51 * look_step + 1e-6);
        }
      } else if (grid.look[k] > 0) {
        ASSERT_LE(value_of(grid.look[k], grid.oldest, grid.newest), cube.newest + 0.51 * look_step);
      }
    }
    EXPECT_GT(observed, 10);
    EXPECT_GT(painted, 10);
    EXPECT_GT(seen, 10);
  }
}

TEST(PageEvidence, OfAnEmptyMapIsNone) {
  const PageEvidence grid = evidence_of(MapLeaves(FreeSpaceMap({.resolution = 0.1}).snapshot()));
  EXPECT_TRUE(grid.look.empty());
  EXPECT_EQ(grid.size, Eigen::Vector3i(0, 0, 0));
}

/// A line of voxels 3 km long: the grid is coarse, and still holds both ends.
TEST(PageEvidence, IsCoarserWhereTheMapIsLarge) {
  FreeSpaceMap map({.resolution = 0.1});
  const int volume = map.add_volume("v", {});
  for (const double x : {-1500.0, 1500.0}) map.paint(volume, {{x, 0.0, 0.0}, 0.5}, 0.0);
  map.paint(volume, {{0.0, 100.0, 100.0}, 0.5}, 0.0);
  const PageEvidence grid = evidence_of(MapLeaves(map.snapshot()));
  EXPECT_GT(grid.cell, 1);
  EXPECT_LE(grid.look.size(), PageEvidence::most_cells);
  EXPECT_EQ(grid.volume.front() + grid.volume.back() > 0, true);
  EXPECT_GE(std::count(grid.volume.begin(), grid.volume.end(), 1), 3);
}

}  // namespace page_evidence_test
}  // namespace clearway
