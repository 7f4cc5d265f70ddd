// Rays that met nothing, against a dense walk along each of them.
#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <set>
#include <stdexcept>
#include <string>

#include "mapping/free_space_map.hpp"
#include "mapping/scans/scan_filter.hpp"
#include "mapping/scans/scan_rays.hpp"
#include "tests/worlds/random_map.hpp"

namespace clearway {
namespace clear_rays_test {

constexpr double resolution = 0.05, range = 2.0;
using worlds::Cell, worlds::cells_in;

Cell cell_of(const Eigen::Vector3d& point) { return worlds::cell_of(point, resolution); }

/// Cells that a ray passes up to `reach`, by steps of a hundredth of a voxel: nearly all of them.
void walk(const Eigen::Vector3d& from, const Eigen::Vector3d& to, double reach, std::set<Cell>& cells) {
  const Eigen::Vector3d way = (to - from).normalized();
  for (double at = 0.0; at <= reach; at += 0.01 * resolution) cells.insert(cell_of(from + at * way));
}

/// A laser's sweep from an odd place: a part of its rays hit something, others met nothing within `range`.
Scan sweep(worlds::Dice& dice, bool with_clear) {
  Scan scan;
  scan.map_from_sensor = Eigen::Translation3d(0.013, -0.207, 0.331) *
                         Eigen::AngleAxisd(0.3, Eigen::Vector3d(1, 2, 3).normalized());
  for (int i = 0; i < 400; ++i) {
    const double angle = i * 2.0 * 3.14159265358979 / 400;
    const Eigen::Vector3d ray(std::cos(angle), std::sin(angle), 0.0);
    const double drawn = dice.uniform(0.0, 2.0);
    if (drawn > 1.0)
      scan.points.emplace_back((dice.uniform(0.3, range) * ray).cast<float>());
    else if (with_clear)
      scan.clear_to.emplace_back((range * ray).cast<float>());
  }
  return scan;
}

TEST(ClearRays, FreeNothingBeyondTheirRangeNorWhatAnotherRayHit) {
  for (const Integration integration : {Integration::safe, Integration::compatible}) {
    for (unsigned seed = 0; seed < 6; ++seed) {
      worlds::Dice dice(seed), same(seed);
      const Scan scan = sweep(dice, true), hits_alone = sweep(same, false);
      ASSERT_GT(scan.clear_to.size(), 100U);
      ASSERT_EQ(scan.points, hits_alone.points);
      MapOptions options{.resolution = resolution, .discretize = seed % 2 == 1, .threads = 1 + int(seed % 3)};
      options.integration = integration;
      const bool is_safe = integration == Integration::safe;
      const double trim = is_safe ? options.margins.trim(range) : 0.0;
      FreeSpaceMap map(options), without(options);
      const ScanCounts counts = map.insert(scan);
      EXPECT_EQ(counts.cleared, scan.clear_to.size());
      EXPECT_EQ(counts.inserted, scan.points.size());
      without.insert(hits_alone);
      const std::set<Cell> free = cells_in(map.snapshot(), VoxelState::seen_free),
                           free_by_hits = cells_in(without.snapshot(), VoxelState::seen_free);
      EXPECT_EQ(cells_in(map.snapshot(), VoxelState::occupied),
                cells_in(without.snapshot(), VoxelState::occupied));
      const Eigen::Vector3d origin = scan.map_from_sensor.translation();
      std::set<Cell> passed;
      for (const Eigen::Vector3f& end : scan.clear_to)
        walk(origin, scan.map_from_sensor * end.cast<double>(), range - trim + 1e-4, passed);
      for (const Eigen::Vector3f& hit : scan.points)
        EXPECT_FALSE(free.contains(cell_of(scan.map_from_sensor * hit.cast<double>())));
      std::size_t by_clear_rays = 0, stray = 0;
      for (const Cell& cell : free) {
        if (free_by_hits.contains(cell)) continue;
        ++by_clear_rays;
        stray += !passed.contains(cell);  // corners that the walk stepped over
      }
      EXPECT_GT(by_clear_rays, 2000U);
      EXPECT_LT(stray, by_clear_rays / 50);
      for (const Cell& cell : free) {
        const Eigen::Vector3d centre =
            resolution * (Eigen::Vector3d(cell[0], cell[1], cell[2]).array() + 0.5);
        ASSERT_LT((centre - origin).norm(), range - trim + 0.87 * resolution);
      }
      for (const Cell& cell : free_by_hits) ASSERT_TRUE(free.contains(cell));
    }
  }
}

TEST(ClearRays, ReachAsFarAsTheyMayAndMaxRangeMinRangeCropAndBodiesHoldForThem) {
  const Eigen::Vector3d probe(1.0, 0.025, 0.025);
  const auto state = [&](const Eigen::Vector3d& at, const ScanFilter& filter, std::size_t cleared) {
    FreeSpaceMap map({.resolution = resolution});
    Scan scan;
    scan.map_from_sensor.translation() = Eigen::Vector3d(0.025, 0.025, 0.025);
    scan.clear_to = {{2.0F, 0, 0}, {NAN, 0, 0}};
    EXPECT_EQ(map.insert(scan, filter).cleared, cleared);
    return map.snapshot().state(at);
  };
  EXPECT_EQ(state(probe, {}, 1), VoxelState::seen_free);
  const double trim = SafeMargins{}.trim(2.0);  // 17.6 mm
  EXPECT_EQ(state({2.025 - trim - 0.06, 0.025, 0.025}, {}, 1), VoxelState::seen_free);
  EXPECT_EQ(state({2.026, 0.025, 0.025}, {}, 1), VoxelState::unknown);
  EXPECT_EQ(state(probe, {.max_range = 0.8}, 1), VoxelState::unknown);
  EXPECT_EQ(state({0.7, 0.025, 0.025}, {.max_range = 0.8}, 1), VoxelState::seen_free);
  EXPECT_EQ(state(probe, {.min_range = 2.1}, 0), VoxelState::unknown);
  ScanFilter crop;
  crop.crop = {Eigen::Vector3d::Constant(-1.0), Eigen::Vector3d::Constant(1.5)};
  EXPECT_EQ(state(probe, crop, 0), VoxelState::unknown);
  ScanFilter body;
  body.bodies = {{{2.0, 0, 0}, {2.1, 0, 0}, 0.2}};
  EXPECT_EQ(state(probe, body, 0), VoxelState::unknown);
}

/// A centimetre's tree ends 327.68 m from its origin.
TEST(ClearRays, ThatEndOutsideOfTheTreeFreeNothingUnlessARangeEndsThemBefore) {
  for (const double max_range : {0.0, 1.0, 400.0}) {
    FreeSpaceMap map({.resolution = 0.01});
    Scan scan;
    scan.map_from_sensor.translation() = Eigen::Vector3d::Constant(0.005);
    scan.clear_to = {{400.0F, 0.0F, 0.0F}, {0.0F, 0.5F, 0.0F}};
    const bool is_inside = max_range == 1.0;
    EXPECT_EQ(map.insert(scan, {.max_range = max_range}).cleared, is_inside ? 2U : 1U) << max_range;
    const Snapshot now = map.snapshot();
    EXPECT_EQ(now.state({0.5, 0.005, 0.005}), is_inside ? VoxelState::seen_free : VoxelState::unknown);
    EXPECT_EQ(now.state({0.005, 0.3, 0.005}), VoxelState::seen_free);
  }
}

TEST(HitsOnly, OccupyTheVoxelsOfTheirPointsAndFreeNothing) {
  Scan scan;
  for (int i = 0; i < 40; ++i) scan.points.emplace_back(2.0F, 0.1F * static_cast<float>(i - 20), 0.3F);
  for (const bool has_hits_only : {false, true}) {
    FreeSpaceMap map(MapOptions{.resolution = 0.05});
    scan.has_hits_only = has_hits_only;
    EXPECT_EQ(map.insert(scan).inserted, 40U);
    const Snapshot now = map.snapshot();
    for (const Eigen::Vector3f& point : scan.points) {
      EXPECT_EQ(now.state(point.cast<double>()), VoxelState::occupied);
      const Eigen::Vector3d way = 0.5 * point.cast<double>();
      EXPECT_EQ(now.state(way), has_hits_only ? VoxelState::unknown : VoxelState::seen_free);
    }
  }
}

/// A workspace is memory only: what a scan before has left in it, its gaps among that, is no evidence.
TEST(HitsOnly, HaveNothingOfTheScanBefore) {
  const FusedTree tree(0.05);
  const ScanInsertion insertion{.integration = Integration::safe};
  ScanWorkspace workspace;
  ScanCounts counts;
  Scan scan;
  for (int i = 0; i < 40; ++i) scan.points.emplace_back(2.0F, 0.1F * static_cast<float>(i - 20), 0.3F);
  EXPECT_FALSE(choose_rays(tree, scan, {}, insertion, workspace, counts).ends.empty());
  ASSERT_NE(workspace.gaps, nullptr);
  scan.has_hits_only = true;
  EXPECT_TRUE(choose_rays(tree, scan, {}, insertion, workspace, counts).ends.empty());
  EXPECT_EQ(workspace.gaps, nullptr);
}

/// Of a stretched or mirrored pose nobody knows where its rays went: each number of a turn times its
/// transpose may be off by 1e-4.
TEST(ClearRays, AndAllOthersComeFromAPoseThatIsRigid) {
  const auto is_taken = [](const Eigen::Vector3d& stretched) {
    FreeSpaceMap map(MapOptions{.resolution = 0.05});
    Scan scan;
    scan.points = {{1.0F, 0.0F, 0.0F}};
    scan.map_from_sensor.linear() =
        Eigen::AngleAxisd(0.3, Eigen::Vector3d(1, 2, 3).normalized()) * stretched.asDiagonal();
    try {
      map.insert(scan);
    } catch (const std::invalid_argument& error) {
      EXPECT_NE(std::string(error.what()).find("map_from_sensor is no rigid pose"), std::string::npos);
      return false;
    }
    return true;
  };
  for (const double by : {4e-5, -4e-5}) EXPECT_TRUE(is_taken(Eigen::Vector3d::Constant(1.0 + by))) << by;
  for (const double by : {6e-5, -6e-5, 0.1, -2.0})
    EXPECT_FALSE(is_taken(Eigen::Vector3d::Constant(1.0 + by))) << by;
  EXPECT_FALSE(is_taken({1.0, 1.0, -1.0}));
  EXPECT_FALSE(is_taken({1.0, 1.001, 1.0}));
}

}  // namespace clear_rays_test
}  // namespace clearway
