#include "mapping/scans/safe_scan.hpp"

#include <gtest/gtest.h>

#include <cstdlib>
#include <set>

#include "tests/worlds/random_map.hpp"

namespace clearway {
namespace safe_scan_test {

using worlds::Dice;
using Cell = std::array<int, 3>;

/// Reached by the steps, cell by cell: the slow and obvious twin.
std::set<Cell> grown(std::set<Cell> cells, const std::vector<GrowthStep>& growth) {
  for (const GrowthStep step : growth) {
    const std::set<Cell> before = cells;
    for (const Cell& c : before) {
      for (int x = -1; x <= 1; ++x)
        for (int y = -1; y <= 1; ++y)
          for (int z = -1; z <= 1; ++z)
            if (std::abs(x) + std::abs(y) + std::abs(z) <= 1 + static_cast<int>(step))
              cells.insert({c[0] + x, c[1] + y, c[2] + z});
    }
  }
  return cells;
}

bool is_clear(const ScanGrid& grid, const Eigen::Vector3i& cell) {
  const unsigned bit = ScanTile::bit_of(cell);
  return (grid.find(cell)->clear[bit >> 6U] >> (bit & 63U) & 1U) != 0;
}

int draw(Dice& dice, int low, int high) { return static_cast<int>(std::floor(dice.uniform(low, high))); }

TEST(SafeScan, TakesExactlyTheCellsNearHitsOutOfTheFreeOnes) {
  const auto f = GrowthStep::faces, e = GrowthStep::edges;
  const std::vector<std::vector<GrowthStep>> growths{{}, {f}, {e}, {e, f}, {e, f, e}, {e, f, e, f}};
  for (unsigned seed = 0; seed < 24; ++seed) {
    Dice dice(seed);
    const int corner = seed % 3 == 0   ? -32768
                       : seed % 3 == 1 ? 32768 - 40
                                       : -20;  // ends of the key range too
    const auto any = [&] {
      return Cell{corner + draw(dice, 0, 40), corner + draw(dice, 0, 40), corner + draw(dice, 0, 40)};
    };
    std::set<Cell> free, hit;
    ScanGrid grid;
    for (int i = 0; i < 6000; ++i) {
      const Cell c = any();
      free.insert(c);
      grid.set_free({c[0], c[1], c[2]});
    }
    for (int i = 0; i < 30; ++i) {
      const Cell c = any();
      hit.insert(c);
      grid.set_occupied({c[0], c[1], c[2]});
    }
    const auto& growth = growths[seed % growths.size()];
    const auto& further = growths[seed / growths.size()];
    const bool fits = growth.size() + further.size() <= 4;
    const SurfaceMargins margins{growth, fits ? further : std::vector<GrowthStep>{}};
    spare_surfaces(grid, margins, 1 + static_cast<int>(seed % 3));
    const std::set<Cell> spared = grown(hit, growth), near = grown(spared, margins.unclear);
    for (const Cell& c : free) {
      const bool kept = growth.empty() || !spared.contains(c);
      ASSERT_EQ(grid.is_free({c[0], c[1], c[2]}), kept) << c[0] << ' ' << c[1] << ' ' << c[2];
      ASSERT_EQ(is_clear(grid, {c[0], c[1], c[2]}), !near.contains(c)) << c[0] << ' ' << c[1] << ' ' << c[2];
    }
    for (const Cell& c : hit) ASSERT_TRUE(grid.is_occupied({c[0], c[1], c[2]}));
  }
}

/// A map ends where its keys do: nothing is beside a cell there that lies at the other end.
TEST(SafeScan, TheTwoEndsOfAMapAreNoNeighbours) {
  const std::vector<GrowthStep> growth{GrowthStep::edges, GrowthStep::faces};
  constexpr int first = -32768, last = 32767;
  for (int axes = 1; axes < 8; ++axes) {  // those along which both cells are at an end
    for (int i = 0; i < 16; ++i) {        // elsewhere in tiles of even and odd numbers
      const bool is_hit_first = i % 2 == 0;
      const Eigen::Vector3i at(5 + (i & 2) * 16, 5 + (i & 4) * 8, 5 + (i & 8) * 4);
      Eigen::Vector3i hit = at, free = at, beside = at;
      for (int axis = 0; axis < 3; ++axis) {
        if ((axes >> axis & 1) == 0) continue;
        hit[axis] = is_hit_first ? first : last;
        free[axis] = is_hit_first ? last : first;
        beside[axis] = is_hit_first ? first + 1 : last - 1;
      }
      ScanGrid grid;
      for (const Eigen::Vector3i& cell : {free, beside}) grid.set_free(cell);
      grid.set_occupied(hit);
      spare_surfaces(grid, {growth, growth}, 1);
      EXPECT_TRUE(grid.is_free(free)) << axes << ' ' << i;
      EXPECT_TRUE(is_clear(grid, free)) << axes << ' ' << i;
      EXPECT_FALSE(grid.is_free(beside)) << axes << ' ' << i;
      EXPECT_FALSE(is_clear(grid, beside)) << axes << ' ' << i;
    }
  }
}

TEST(SafeScan, TheNeighbourhoodIsTheBandInWholeVoxelsAtMostFour) {
  for (const double resolution : {0.1, 0.05, 0.03, 0.02, 0.01, 0.005, 0.0025}) {
    const auto growth = growth_of(0.02, resolution);
    const int n = std::max(1, static_cast<int>(std::min(4.0, std::round(0.02 / resolution))));
    int along = 0, sum = 0;
    for (const Cell& c : grown({{0, 0, 0}}, growth)) {
      along = std::max({along, std::abs(c[0]), std::abs(c[1]), std::abs(c[2])});
      sum = std::max(sum, std::abs(c[0]) + std::abs(c[1]) + std::abs(c[2]));
    }
    EXPECT_EQ(along, n) << resolution;
    EXPECT_EQ(sum, resolution > 0.04 ? 1 : n + (n + 1) / 2) << resolution;
  }
  EXPECT_TRUE(growth_of(0.0, 0.02).empty());
}

TEST(SafeScan, ClearIsWhatLiesTwoBandsFromAHitAtMostFourVoxels) {
  for (const double resolution : {0.1, 0.05, 0.03, 0.02, 0.01, 0.005, 0.0025}) {
    std::vector<GrowthStep> growth = growth_of(0.02, resolution);
    const auto spared = static_cast<int>(growth.size());
    for (const GrowthStep step : clear_growth_of(0.02, resolution)) growth.push_back(step);
    int along = 0;
    for (const Cell& c : grown({{0, 0, 0}}, growth)) along = std::max(along, std::abs(c[0]));
    EXPECT_EQ(along, std::min(4, 2 * spared)) << resolution;
  }
  EXPECT_TRUE(clear_growth_of(0.0, 0.02).empty());
}

TEST(SafeScan, TrimsByTheNoiseOfTheRangeUpToItsLimit) {
  const SafeMargins margins;
  EXPECT_DOUBLE_EQ(margins.trim(0.0), 2 * 0.0012);
  EXPECT_DOUBLE_EQ(margins.trim(2.0), 2 * (0.0012 + 4 * 0.0019));
  EXPECT_DOUBLE_EQ(margins.trim(100.0), 2 * 0.05);
}

/// As its options say: 2 sigma of a structured-light camera at this range, capped.
double noise_before_the_end(double range) { return 2.0 * std::min(0.0012 + 0.0019 * range * range, 0.05); }

FreeSpaceMap map_with(double resolution, Integration integration, int threads = 1) {
  MapOptions options;
  options.resolution = resolution;
  options.integration = integration;
  options.threads = threads;
  return FreeSpaceMap(options);
}

TEST(SafeScan, OfOneScanSafeFreesASubsetOfWhatCompatibleFreesAndHitsTheSame) {
  for (unsigned seed = 0; seed < 6; ++seed) {
    Dice dice(seed);
    const double resolution = dice.uniform(0.02, 0.06);
    const Scan scan = worlds::random_scan(dice, 60);
    FreeSpaceMap safe = map_with(resolution, Integration::safe);
    FreeSpaceMap compatible = map_with(resolution, Integration::compatible);
    const ScanCounts counts = safe.insert(scan, {.max_range = 0.8});
    EXPECT_EQ(counts.inserted, compatible.insert(scan, {.max_range = 0.8}).inserted);
    const Snapshot ours = safe.snapshot(), all = compatible.snapshot();
    EXPECT_EQ(ours.counts().occupied, all.counts().occupied);
    EXPECT_LT(ours.counts().seen_free, all.counts().seen_free);
    EXPECT_GT(ours.counts().seen_free, all.counts().seen_free / 2);
    ours.visit_leaves([&](const Voxel& leaf) { ASSERT_EQ(all.state(leaf.center), leaf.state); });
  }
}

/// Also where the voxel's centre, at which its one ray ends, is farther: whatever the threads.
TEST(SafeScan, DiscretizedAReturnWithinRangeBlocksItsVoxel) {
  constexpr double resolution = 0.1, max_range = 1.0;
  int beside = 0;
  for (unsigned seed = 0; seed < 6; ++seed) {
    Dice dice(seed);
    Scan scan;
    scan.map_from_sensor.translation() = dice.point(0.3);
    for (int i = 0; i < 400; ++i)
      scan.points.emplace_back((dice.point(1.0).normalized() * dice.uniform(0.85, 1.1)).cast<float>());
    std::vector<Snapshot> maps;
    for (const int threads : {1, 3}) {
      FreeSpaceMap map({.resolution = resolution, .discretize = true, .threads = threads});
      const ScanCounts counts = map.insert(scan, {.max_range = max_range});
      const auto near = std::count_if(scan.points.begin(), scan.points.end(),
                                      [](const Eigen::Vector3f& point) { return point.norm() <= max_range; });
      EXPECT_NEAR(static_cast<double>(counts.inserted), static_cast<double>(near), 2.0);
      EXPECT_EQ(counts.inserted + counts.beyond_range, scan.points.size());
      maps.push_back(map.snapshot());
    }
    for (const Eigen::Vector3f& point : scan.points) {
      if (!(point.norm() < max_range - 1e-6)) continue;
      const Eigen::Vector3d at = scan.map_from_sensor * point.cast<double>();
      EXPECT_EQ(maps[0].state(at), VoxelState::occupied) << seed;
      const Eigen::Vector3d centre = ((at / resolution).array().floor() + 0.5) * resolution;
      beside += (centre - scan.map_from_sensor.translation()).norm() > max_range ? 1 : 0;
    }
    EXPECT_EQ(maps[0].counts().seen_free, maps[1].counts().seen_free);
    EXPECT_EQ(maps[0].counts().occupied, maps[1].counts().occupied);
  }
  EXPECT_GT(beside, 100);
}

/// Rays to a slanted plane, from a place on its upper side, at a grid of points shifted at random.
Scan look_at_plane(Dice& dice, const Eigen::Isometry3d& map_from_plane) {
  Scan scan;
  scan.map_from_sensor.translation() =
      map_from_plane * Eigen::Vector3d(dice.uniform(-2, 2), dice.uniform(-2, 2), dice.uniform(0.1, 1.5));
  const double dx = dice.uniform(0, 0.01), dy = dice.uniform(0, 0.01);
  for (double x = -0.5; x < 0.5; x += 0.01) {
    for (double y = -0.5; y < 0.5; y += 0.01) {
      const Eigen::Vector3d point = map_from_plane * Eigen::Vector3d(x + dx, y + dy, 0.0);
      scan.points.push_back((point - scan.map_from_sensor.translation()).cast<float>());
    }
  }
  return scan;
}

TEST(SafeScan, NoVoxelOfASlantedPlaneIsFreeWhenNoRayIsFartherFromTheNextThanTheBand) {
  std::size_t eroded = 0;  // by compatible integration
  for (unsigned seed = 0; seed < 4; ++seed) {
    Dice dice(seed);
    Eigen::Isometry3d map_from_plane(Eigen::AngleAxisd(dice.uniform(0, 3), dice.point(1.0).normalized()));
    map_from_plane.pretranslate(dice.point(0.3));
    FreeSpaceMap safe = map_with(0.02, Integration::safe);
    FreeSpaceMap compatible = map_with(0.02, Integration::compatible);
    for (int i = 0; i < 12; ++i) {
      const Scan scan = look_at_plane(dice, map_from_plane);
      safe.insert(scan);
      compatible.insert(scan);
    }
    const Snapshot ours = safe.snapshot(), all = compatible.snapshot();
    for (int i = 0; i < 20000; ++i) {
      const Eigen::Vector3d on_plane(dice.uniform(-0.45, 0.45), dice.uniform(-0.45, 0.45), 0.0);
      const Eigen::Vector3d point = map_from_plane * on_plane;
      ASSERT_NE(ours.state(point), VoxelState::seen_free) << point.transpose();
      eroded += all.state(point) == VoxelState::seen_free ? 1 : 0;
    }
    EXPECT_GT(ours.counts().seen_free, 10000U);
  }
  EXPECT_GT(eroded, 100U);
}

TEST(SafeScan, ARayFreesItsWayUpToTheNoiseOfItsRangeBeforeItsEndAndNoFarther) {
  constexpr double resolution = 0.01, band = 0.02;
  for (const bool discretize : {false, true}) {
    for (const double range : {0.505, 1.005, 2.005, 3.005, 4.005, 6.005}) {
      FreeSpaceMap map(
          {.resolution = resolution, .discretize = discretize, .integration = Integration::safe});
      Scan scan;
      scan.map_from_sensor.translation() = Eigen::Vector3d::Constant(0.005);
      scan.points = {{static_cast<float>(range - 0.005), 0.0F, 0.0F}};
      map.insert(scan);
      const Snapshot seen = map.snapshot();
      double farthest = 0.0;  // the far face of the last voxel that is free
      for (double x = 0.005; x < range + 0.1; x += resolution) {
        const VoxelState state = seen.state({x, 0.005, 0.005});
        if (state == VoxelState::seen_free) farthest = x + resolution / 2;
      }
      const double noise = noise_before_the_end(range - 0.005);
      const double end = std::min(range - noise, range - resolution / 2 - band);
      EXPECT_LE(farthest, end + resolution + 1e-6) << range;  // the voxel in which the trimmed ray ends, too
      EXPECT_GE(farthest, end - resolution - 1e-6) << range;
      EXPECT_EQ(seen.state({range, 0.005, 0.005}), VoxelState::occupied) << range;
    }
  }
}

/// A wall 2 m ahead, and before it a plate 1 m ahead when there is one.
Scan look_at_wall(bool plate) {
  Scan scan;
  scan.map_from_sensor.translation() = Eigen::Vector3d::Constant(0.013);
  for (float y = -0.4F; y < 0.4F; y += 0.005F) {
    for (float z = -0.4F; z < 0.4F; z += 0.005F) {
      const bool meets = plate && std::abs(y) < 0.2F && std::abs(z) < 0.2F;
      scan.points.push_back((meets ? 0.5F : 1.0F) * Eigen::Vector3f(2.0F, y, z));
    }
  }
  return scan;
}

/// The states of the voxels that a scan hit.
std::set<VoxelState> states_of_hits(const FreeSpaceMap& map, const Scan& scan) {
  std::set<VoxelState> states;
  const Snapshot now = map.snapshot();
  for (const Eigen::Vector3f& point : scan.points)
    states.insert(now.state(scan.map_from_sensor * point.cast<double>()));
  return states;
}

/// The points of a scan that are not farther than this.
Scan nearer(Scan scan, float range) {
  std::erase_if(scan.points, [&](const Eigen::Vector3f& point) { return point.norm() > range; });
  return scan;
}

TEST(SafeScan, WhatTheNewestScanHitIsBlockedWhateverThePast) {
  for (const double resolution : {0.05, 0.02, 0.01}) {
    for (const int past : {1, 3, 20}) {
      FreeSpaceMap map = map_with(resolution, Integration::safe),
                   old = map_with(resolution, Integration::compatible);
      for (int i = 0; i < past; ++i) map.insert(look_at_wall(false));
      for (int i = 0; i < past; ++i) old.insert(look_at_wall(false));
      const Scan plate = nearer(look_at_wall(true), 1.3F);
      EXPECT_EQ(states_of_hits(map, plate), std::set{VoxelState::seen_free});
      map.insert(look_at_wall(true));
      old.insert(look_at_wall(true));
      EXPECT_EQ(states_of_hits(map, plate), std::set{VoxelState::occupied});
      const VoxelState expected = past > 2 ? VoxelState::seen_free : VoxelState::occupied;
      EXPECT_EQ(states_of_hits(old, plate), std::set{expected}) << "OctoMap's, after " << past;
    }
  }
}

TEST(SafeScan, AHitInPaintThatWasSeenFreeForLongIsAConflict) {
  FreeSpaceMap map = map_with(0.02, Integration::safe);
  map.paint(map.add_volume("free", {}), {Eigen::Vector3d(1.0, 0.0, 0.0), 0.3});
  for (int i = 0; i < 20; ++i) map.insert(look_at_wall(false));
  EXPECT_EQ(map.snapshot().counts().conflict, 0U);
  map.insert(look_at_wall(true));
  EXPECT_EQ(states_of_hits(map, nearer(look_at_wall(true), 1.3F)), std::set{VoxelState::conflict});
  EXPECT_EQ(map.conflicts().records.size(), map.snapshot().counts().conflict);
}

TEST(SafeScan, ASpuriousReturnIsGoneAfterThreeLooks) {
  FreeSpaceMap map = map_with(0.02, Integration::safe);
  for (int i = 0; i < 12; ++i) map.insert(look_at_wall(false));
  const Snapshot before = map.snapshot();
  Scan scan = look_at_wall(false);
  scan.points.push_back({0.9F, 0.05F, 0.07F});
  map.insert(scan);
  EXPECT_EQ(map.snapshot().counts().occupied, before.counts().occupied + 1);
  for (int i = 0; i < 3; ++i) {
    EXPECT_EQ(map.snapshot().counts().occupied, before.counts().occupied + 1) << i;
    map.insert(look_at_wall(false));
  }
  EXPECT_EQ(map.snapshot().counts().occupied, before.counts().occupied);
}

TEST(SafeScan, WhatLeftIsFreeAfterFiveScansThatSeeClearlyThroughItsPlace) {
  for (const double resolution : {0.05, 0.02, 0.01, 0.005}) {
    FreeSpaceMap map = map_with(resolution, Integration::safe);
    for (int i = 0; i < 30; ++i) map.insert(look_at_wall(true));
    const Scan plate = nearer(look_at_wall(true), 1.3F);
    EXPECT_EQ(states_of_hits(map, plate), std::set{VoxelState::occupied});
    for (int i = 0; i < 5; ++i) map.insert(look_at_wall(false));
    EXPECT_EQ(states_of_hits(map, plate), std::set{VoxelState::seen_free}) << resolution;
    EXPECT_EQ(states_of_hits(map, look_at_wall(false)), std::set{VoxelState::occupied}) << resolution;
  }
}

/// Rays to a wall 2 m ahead, and before it to a pole of this diameter 1 m ahead; a sensor whose pose is
/// wrong.
Scan look_past_pole(Dice& dice, double diameter, double shift, double turn) {
  Scan scan;
  for (double y = -0.3; y < 0.3; y += 0.0025) {
    for (double z = -0.3; z < 0.3; z += 0.005) {
      const Eigen::Vector3d wall(2.0, y, z);
      const bool meets = std::abs(0.5 * y) < 0.5 * diameter;
      scan.points.push_back(((meets ? 0.5 : 1.0) * wall).cast<float>());
    }
  }
  const Eigen::Vector3d axis = dice.point(1.0).normalized();
  scan.map_from_sensor.rotate(Eigen::AngleAxisd(turn * dice.uniform(-1.7, 1.7), axis));
  scan.map_from_sensor.translation() = dice.point(1.7 * shift);  // uniform, of that standard deviation
  return scan;
}

TEST(SafeScan, APoleThinnerThanAVoxelIsNotErasedByLooksFromPosesThatAreWrong) {
  for (const double resolution : {0.02, 0.01}) {
    FreeSpaceMap map = map_with(resolution, Integration::safe);
    Dice dice(11);
    std::size_t looked = 0, freed = 0;
    for (int i = 0; i < 30; ++i) {
      map.insert(look_past_pole(dice, 0.006, 0.006, 0.0035));
      const Snapshot now = map.snapshot();
      for (double z = -0.1; z < 0.1; z += 0.005, ++looked)
        freed += now.state({1.0, 0.0, z}) == VoxelState::seen_free ? 1 : 0;
    }
    EXPECT_LE(freed, looked / 100) << resolution;
  }
}

TEST(SafeScan, TheMapIsTheSameWhateverTheThreads) {
  std::vector<Snapshot> snapshots;
  for (const int threads : {1, 2, 5}) {
    Dice dice(3);
    FreeSpaceMap map = map_with(0.02, Integration::safe, threads);
    for (int i = 0; i < 5; ++i) map.insert(worlds::random_scan(dice, 300));
    snapshots.push_back(map.snapshot());
  }
  for (const Snapshot& other : {snapshots[1], snapshots[2]}) {
    std::size_t leaves = 0, others = 0;
    snapshots[0].visit_leaves([&](const Voxel& leaf) {
      ++leaves;
      ASSERT_EQ(other.voxel(leaf.center).log_odds, leaf.log_odds);
    });
    other.visit_leaves([&](const Voxel&) { ++others; });
    EXPECT_EQ(others, leaves);
  }
}

}  // namespace safe_scan_test
}  // namespace clearway
