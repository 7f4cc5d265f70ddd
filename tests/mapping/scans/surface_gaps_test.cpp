#include "mapping/scans/surface_gaps.hpp"

#include <gtest/gtest.h>

#include <functional>

#include "mapping/free_space_map.hpp"
#include "tests/worlds/random_map.hpp"

namespace clearway {
namespace surface_gaps_test {

using worlds::Dice;

constexpr double degree = M_PI / 180.0;

/// Range along a ray, map frame; infinite: it meets nothing.
using World = std::function<double(const Eigen::Vector3d& from, const Eigen::Vector3d& way)>;

World plane(const Eigen::Vector3d& normal, double offset) {
  return [=](const Eigen::Vector3d& from, const Eigen::Vector3d& way) {
    const double speed = normal.dot(way), range = (offset - normal.dot(from)) / speed;
    return speed != 0.0 && range > 0.0 ? range : HUGE_VAL;
  };
}

/// A lidar of rings at these elevations, turned at random about its axis; returns up to `longest`.
std::vector<Eigen::Vector3f> rings(Dice& dice, const World& world, const Eigen::Isometry3d& pose,
                                   const std::vector<double>& elevations, int around, double longest) {
  std::vector<Eigen::Vector3f> points;
  const double turned = dice.uniform(0.0, 2 * M_PI);
  for (const double elevation : elevations) {
    for (int i = 0; i < around; ++i) {
      const double azimuth = turned + 2 * M_PI * i / around;
      const Eigen::Vector3d way(std::cos(elevation) * std::cos(azimuth),
                                std::cos(elevation) * std::sin(azimuth), std::sin(elevation));
      const double range = world(pose.translation(), pose.linear() * way);
      if (range < longest) points.push_back((range * way).cast<float>());
    }
  }
  return points;
}

std::vector<double> evenly(double first, double last, int count) {
  std::vector<double> values;
  for (int i = 0; i < count; ++i) values.push_back(degree * (first + (last - first) * i / (count - 1)));
  return values;
}

/// Cells of the map that a gap crosses, by points far denser than voxels.
bool crosses(const SurfaceGap& gap, const Eigen::Vector3i& cell) {
  for (double part = 0.0; part <= 1.0; part += 0.001) {
    const Eigen::Vector3d at = gap.from + part * (gap.to - gap.from);
    if ((at.array().floor().cast<int>() == cell.array()).all()) return true;
  }
  return false;
}

// The promise, on grounds of every tilt, lidars of every make and all heights: of what lies between the rings
// of a drive nothing is called free, and what lies above it still is.
TEST(SurfaceGaps, TheGroundBetweenTheRingsOfALidarIsNotFree) {
  int freed_by_all = 0;
  for (unsigned seed = 0; seed < 4; ++seed) {
    Dice dice(seed);
    const double height = dice.uniform(0.4, 2.0), tilt = dice.uniform(-0.03, 0.03);
    const Eigen::Vector3d normal = Eigen::Vector3d(tilt, dice.uniform(-0.03, 0.03), 1.0).normalized();
    const double offset = -height + dice.uniform(-0.1, 0.1);
    const World ground = plane(normal, offset);
    const std::vector<double> elevations = seed % 2 == 0 ? evenly(2.0, -24.8, 32) : evenly(15.0, -15.0, 16);
    MapOptions options{.resolution = 0.15 * height};
    FreeSpaceMap safe(options);
    options.integration = Integration::compatible;
    FreeSpaceMap compatible(options);
    for (int i = 0; i < 25; ++i) {
      Scan scan;
      scan.map_from_sensor.rotate(Eigen::AngleAxisd(0.02, dice.point(1.0).normalized()));
      scan.map_from_sensor.translation() = Eigen::Vector3d(0.4 * i, 0.02 * i, dice.uniform(-0.01, 0.01));
      scan.points = rings(dice, ground, scan.map_from_sensor, elevations, 900, 25.0 * height);
      safe.insert(scan);
      compatible.insert(scan);
    }
    const Snapshot ours = safe.snapshot(), all = compatible.snapshot();
    int freed = 0, above = 0;
    constexpr int count = 4000;
    for (int i = 0; i < count; ++i) {
      Eigen::Vector3d point(dice.uniform(0.0, 10.0), dice.uniform(-4.0, 4.0) * height, 0.0);
      point.z() = (offset - normal.head<2>().dot(point.head<2>())) / normal.z();
      freed += ours.state(point) == VoxelState::seen_free;
      freed_by_all += all.state(point) == VoxelState::seen_free;
      above += ours.state(point + 2.5 * options.resolution * normal) == VoxelState::seen_free;
    }
    EXPECT_LE(freed, count / 50) << seed;
    EXPECT_GE(above, count * 95 / 100) << seed;
  }
  EXPECT_GE(freed_by_all, 1000);
}

TEST(SurfaceGaps, OfAPlaneOnlyCellsThatItCrossesAreTakenOut) {
  std::size_t taken = 0;
  for (unsigned seed = 0; seed < 8; ++seed) {
    Dice dice(seed);
    const double resolution = dice.uniform(0.1, 0.4);
    const Eigen::Vector3d normal = dice.point(1.0).normalized();
    const double offset = dice.uniform(-1.5, -0.5);
    GapSearch search{.resolution = resolution};
    search.map_from_sensor.rotate(Eigen::AngleAxisd(dice.uniform(0.0, 3.0), dice.point(1.0).normalized()));
    const std::vector<Eigen::Vector3f> hits =
        rings(dice, plane(normal, offset), search.map_from_sensor, evenly(30.0, -30.0, 24), 720, 12.0);
    SurfaceGaps gaps;
    ScanGrid grid;
    const int reach = static_cast<int>(12.0 / resolution) / 2;
    for (int x = -reach; x < reach; ++x)
      for (int y = -reach; y < reach; ++y)
        for (int z = -reach; z < reach; ++z) grid.set_free({x, y, z});
    spare_gaps(gaps.find(hits, {}, search), nullptr, grid);
    for (int x = -reach; x < reach; ++x) {
      for (int y = -reach; y < reach; ++y) {
        for (int z = -reach; z < reach; ++z) {
          if (grid.is_free({x, y, z})) continue;
          ++taken;
          const Eigen::Vector3d center = resolution * (Eigen::Vector3d(x, y, z).array() + 0.5).matrix();
          const double half = 0.5 * resolution * normal.cwiseAbs().sum();
          ASSERT_LE(std::abs(normal.dot(center) - offset), half + 0.2 * resolution) << center.transpose();
        }
      }
    }
  }
  EXPECT_GT(taken, 1000U);
}

/// A lidar before a wall at a slant, 64 rays in one row.
std::vector<Eigen::Vector3f> slanted_wall() {
  std::vector<Eigen::Vector3f> hits;
  for (int i = 0; i < 64; ++i) {
    const double azimuth = degree * (5.0 + 0.5 * i);
    hits.push_back(
        (Eigen::Vector3d(std::cos(azimuth), std::sin(azimuth), 0.0) / std::sin(azimuth)).cast<float>());
  }
  return hits;
}

TEST(SurfaceGaps, AWallSeenAtASlantGoesOnBetweenTheRaysOfAFlatScan) {
  SurfaceGaps gaps;
  for (const double turn : {0.0, 100.0, 171.0, 260.0}) {  // over the seam of the azimuth, too
    GapSearch search{.resolution = 0.05};
    std::vector<Eigen::Vector3f> hits = slanted_wall();
    for (Eigen::Vector3f& hit : hits)
      hit = Eigen::AngleAxisf(static_cast<float>(degree * turn), Eigen::Vector3f::UnitZ()) * hit;
    search.map_from_sensor.rotate(Eigen::AngleAxisd(-degree * turn, Eigen::Vector3d::UnitZ()));
    const std::vector<SurfaceGap> found = gaps.find(hits, {}, search);
    for (double x = 5.0; x < 10.0; x += 0.05) {  // the wall is y = 1
      const Eigen::Vector3i cell(static_cast<int>(std::floor(x / 0.05)), 20, 0),
          before = cell - Eigen::Vector3i::UnitY();
      EXPECT_TRUE(
          std::any_of(found.begin(), found.end(),
                      [&](const SurfaceGap& gap) { return crosses(gap, cell) || crosses(gap, before); }))
          << turn << " " << x;
    }
  }
}

TEST(SurfaceGaps, AnEdgeBeforeABackgroundIsNoGap) {
  Dice dice(1);
  for (int i = 0; i < 20; ++i) {
    const double far = dice.uniform(4.0, 8.0), half = dice.uniform(0.3, 0.8);
    const World scene = [&](const Eigen::Vector3d& from, const Eigen::Vector3d& way) {
      const double plate = plane(Eigen::Vector3d::UnitX(), 1.5)(from, way);
      const Eigen::Vector3d at = from + plate * way;
      if (plate < HUGE_VAL && std::abs(at.y()) < half && std::abs(at.z()) < half) return plate;
      return plane(Eigen::Vector3d::UnitX(), far)(from, way);
    };
    SurfaceGaps gaps;
    const std::vector<Eigen::Vector3f> hits =
        rings(dice, scene, Eigen::Isometry3d::Identity(), evenly(30.0, -30.0, 120), 720, 9.0);
    for (const SurfaceGap& gap : gaps.find(hits, {}, {.resolution = 0.02}))
      EXPECT_LT(std::abs(gap.from.x() - gap.to.x()) * 0.02, 1.0);
  }
}

TEST(SurfaceGaps, ARayThatHitsNothingParts) {
  const std::vector<Eigen::Vector3f> hits{{4.0F, 0.30F, 0.0F}, {5.0F, 0.0F, 0.0F}};
  const std::vector<Eigen::Vector3f> between{{6.0F, 0.2F, 0.0F}};
  SurfaceGaps gaps;
  EXPECT_EQ(gaps.find(hits, {}, {.resolution = 0.1}).size(), 1U);
  EXPECT_EQ(gaps.find(hits, between, {.resolution = 0.1}).size(), 0U);
  EXPECT_EQ(gaps.find(hits, {}, {.resolution = 0.1}).size(), 1U);  // nothing is kept of the scan before
  const std::vector<Eigen::Vector3f> before{{2.0F, 0.07F, 0.0F}};  // it ends before both
  EXPECT_EQ(gaps.find(hits, before, {.resolution = 0.1}).size(), 1U);
}

TEST(SurfaceGaps, AShadowWiderThanThreeUsualStepsParts) {
  for (const double shadow : {0.45, 0.8, 1.5}) {  // degrees, of rays 0.2 degrees apart
    std::vector<Eigen::Vector3f> hits;
    for (int i = -40; i <= 40; ++i) {
      const double azimuth = degree * (0.2 * i + (i > 0 ? shadow - 0.2 : 0.0)), range = i > 0 ? 2.5 : 2.0;
      hits.push_back((range * Eigen::Vector3d(std::cos(azimuth), std::sin(azimuth), 0.0)).cast<float>());
    }
    SurfaceGaps gaps;
    EXPECT_EQ(gaps.find(hits, {}, {.resolution = 0.02}).size(), shadow < 0.6 ? 1U : 0U) << shadow;
  }
}

TEST(SurfaceGaps, ACameraThatLooksAlongZSeesTheFloorToGoOn) {
  Dice dice(5);
  GapSearch search{.resolution = 0.05};
  search.map_from_sensor.linear() << 0, 0, 1, -1, 0, 0, 0, -1, 0;  // x right, y down, z forward
  search.map_from_sensor.translation().z() = 0.5;
  std::vector<Eigen::Vector3f> hits;
  ScanGrid grid;
  for (int row = 1; row < 60; ++row) {
    for (int column = -60; column <= 60; ++column) {
      const Eigen::Vector3f way(static_cast<float>(column) / 120.0F, static_cast<float>(row) / 120.0F, 1.0F);
      if (0.5F / way.y() < 8.0F) hits.push_back(way * (0.5F / way.y()));
    }
  }
  for (int x = 0; x < 200; ++x)
    for (int y = -60; y < 60; ++y) grid.set_free({x, y, 0}), grid.set_free({x, y, -1});
  SurfaceGaps gaps;
  spare_gaps(gaps.find(hits, {}, search), nullptr, grid);
  int missed = 0;
  for (int i = 0; i < 2000; ++i) {
    const double x = dice.uniform(4.0, 7.0), y = dice.uniform(-0.4, 0.4) * x;
    const int u = static_cast<int>(std::floor(x / 0.05)), v = static_cast<int>(std::floor(y / 0.05));
    missed += grid.is_free({u, v, 0}) && grid.is_free({u, v, -1});
  }
  EXPECT_LE(missed, 100);
}

// What the tree holds occupied is no longer seen clearly, but it is still missed; what it does not is spared.
TEST(SurfaceGaps, OnlyLooksThatAreClearAreTakenFromWhatIsOccupied) {
  FreeSpaceMap map({.resolution = 0.1, .integration = Integration::compatible});
  Scan hit;
  hit.map_from_sensor.translation() = Eigen::Vector3d(3.05, 0.05, 0.55);
  hit.points = {{0.0F, 0.0F, -0.5F}};
  map.insert(hit);
  const SurfaceGap gap{{20.5, 0.5, 0.5}, {40.5, 0.5, 0.5}, Eigen::Vector3d::UnitY(), 0.0, 0.0};
  ScanGrid grid;
  for (int x = 15; x < 45; ++x) {
    grid.set_free({x, 0, 0});
    grid.tile({x, 0, 0}).clear.fill(~std::uint64_t{0});
    grid.tile({x, 0, 0}).spared.fill(0);
  }
  const auto has = [&](const std::array<std::uint64_t, ScanTile::words>& bits, int x) {
    const unsigned bit = ScanTile::bit_of({x, 0, 0});
    return (bits[bit >> 6U] >> (bit & 63U) & 1U) != 0;
  };
  const Snapshot known = map.snapshot();
  spare_gaps(std::vector{gap}, &known.tree(), grid);
  for (int x = 15; x < 45; ++x) {
    const ScanTile& tile = *grid.find({x, 0, 0});
    const bool between = x > 20 && x < 40, occupied = x == 30;
    if (x == 20 || x == 40) continue;  // the hits' own
    EXPECT_EQ(has(tile.free, x), !between || occupied) << x;
    EXPECT_EQ(has(tile.clear, x), !between) << x;
    EXPECT_EQ(has(tile.spared, x), between && !occupied) << x;
  }
}

// A ceiling is a floor upside down: beyond the ring that is nearest to the sensor it goes on as far.
TEST(SurfaceGaps, ACeilingGoesOnTowardsTheSensorAsAFloorDoes) {
  const auto nearest = [](double height) {  // metres, of what is found to the axis; and of the nearest hit
    Dice dice(3);
    const World surface = plane(Eigen::Vector3d::UnitZ(), height);
    const std::vector<Eigen::Vector3f> hits =
        rings(dice, surface, Eigen::Isometry3d::Identity(), evenly(28.0, -28.0, 24), 360, 12.0);
    SurfaceGaps gaps;
    constexpr double resolution = 0.05;
    std::pair<double, double> near(HUGE_VAL, HUGE_VAL);
    for (const SurfaceGap& gap : gaps.find(hits, {}, {.resolution = resolution}))
      for (const Eigen::Vector3d& end : {gap.from, gap.to})
        near.first = std::min(near.first, resolution * end.head<2>().norm());
    for (const Eigen::Vector3f& hit : hits) near.second = std::min<double>(near.second, hit.head<2>().norm());
    return near;
  };
  const auto [floor, ring] = nearest(-1.0);
  const auto [ceiling, same_ring] = nearest(1.0);
  EXPECT_NEAR(ring, same_ring, 1e-5);
  EXPECT_LT(floor, ring - 0.02);
  EXPECT_NEAR(ceiling, floor, 1e-4);
}

// From a sensor that stands still, before a table's edge and a wall: who walked between them is forgotten.
TEST(SurfaceGaps, WhatLeftBetweenAnEdgeAndAWallIsForgotten) {
  const auto scene = [](bool somebody) {
    return [somebody](const Eigen::Vector3d& from, const Eigen::Vector3d& way) {
      const auto wall = [&](double x) { return plane(Eigen::Vector3d::UnitX(), x)(from, way); };
      const double top = plane(Eigen::Vector3d::UnitZ(), -0.65)(from, way);
      const double x = top < HUGE_VAL ? top * way.x() : 0.0;
      if (x > 1.0 && x < 2.5) return top;
      const double person = wall(3.0);
      return somebody && std::abs(person * way.y()) < 0.3 ? person : wall(3.5);
    };
  };
  Dice dice(1);
  FreeSpaceMap map({.resolution = 0.05});
  const auto look = [&](bool somebody) {
    Scan scan;
    scan.points = rings(dice, scene(somebody), scan.map_from_sensor, evenly(15.0, -25.0, 32), 900, 8.0);
    map.insert(scan);
  };
  const auto occupied = [&] {
    const Snapshot now = map.snapshot();
    int count = 0;
    for (const double x : {2.975, 3.025})
      for (double y = -0.275; y < 0.3; y += 0.05)
        for (double z = -0.975; z < 0.5; z += 0.05) count += now.state({x, y, z}) == VoxelState::occupied;
    return count;
  };
  look(false);
  look(true);
  EXPECT_GT(occupied(), 20);
  for (int i = 0; i < 40; ++i) look(false);
  EXPECT_EQ(occupied(), 0);
}

// Filtered points are in the map's frame, those of a scan in the sensor's: the same map of both.
TEST(SurfaceGaps, AFilterThatDropsNothingChangesNothing) {
  Dice dice(7);
  const World ground = plane(Eigen::Vector3d(0.02, -0.01, 1.0).normalized(), -0.8);
  for (const bool filtered : {false, true}) {
    FreeSpaceMap map({.resolution = 0.1});
    Dice same(8);
    for (int i = 0; i < 5; ++i) {
      Scan scan;
      scan.map_from_sensor.rotate(Eigen::AngleAxisd(1.0 + i, Eigen::Vector3d(0.02, 0.01, 1.0).normalized()));
      scan.map_from_sensor.translation().x() = i;
      scan.points = rings(same, ground, scan.map_from_sensor, evenly(15.0, -15.0, 16), 720, 15.0);
      map.insert(scan, {.min_range = filtered ? 0.01 : 0.0});
    }
    int freed = 0;
    for (int i = 0; i < 2000; ++i) {
      const double x = dice.uniform(-6.0, 10.0), y = dice.uniform(-6.0, 6.0);
      const double z = -0.8 * Eigen::Vector3d(0.02, -0.01, 1.0).norm() - 0.02 * x + 0.01 * y;
      freed += map.snapshot().state({x, y, z}) == VoxelState::seen_free;
    }
    EXPECT_LE(freed, 60) << filtered;
  }
}

TEST(SurfaceGaps, NeighboursThatNoiseWidthOrDistancePartsAreNone) {
  SurfaceGaps gaps;
  const auto count = [&](const Eigen::Vector3f& a, const Eigen::Vector3f& b, double resolution) {
    return gaps.find(std::vector<Eigen::Vector3f>{a, b}, {}, {.resolution = resolution}).size();
  };
  const SafeMargins margins;
  const auto trim = static_cast<float>(margins.trim(3.0));
  EXPECT_EQ(count({3.0F, 0.0F, 0.0F}, {3.0F - 1.9F * trim, 0.06F, 0.0F}, 0.01), 0U);  // noise explains it
  EXPECT_EQ(count({3.0F, 0.0F, 0.0F}, {3.0F - 2.2F * trim, 0.06F, 0.0F}, 0.01), 1U);
  EXPECT_EQ(count({3.0F, 0.0F, 0.0F}, {3.0F - 2.2F * trim, 0.06F, 0.0F}, 0.2), 0U);  // nearer than a voxel
  EXPECT_EQ(count({5.0F, 0.0F, 0.0F}, {4.0F, 0.33F, 0.0F}, 0.1), 1U);
  EXPECT_EQ(count({5.0F, 0.0F, 0.0F}, {4.0F, 0.37F, 0.0F}, 0.1), 0U);  // more than 5 degrees
  EXPECT_EQ(count({5.0F, 0.0F, 0.0F}, {4.0F, 0.016F, 0.0F}, 0.1), 1U);
  EXPECT_EQ(count({5.0F, 0.0F, 0.0F}, {4.0F, 0.008F, 0.0F}, 0.1), 0U);  // along the ray
  const float inf = HUGE_VALF, nan = std::nanf("");
  EXPECT_EQ(count({nan, 0.0F, 0.0F}, {4.0F, 0.33F, 0.0F}, 0.1), 0U);
  EXPECT_EQ(count({inf, 0.0F, 0.0F}, {4.0F, 0.33F, 0.0F}, 0.1), 0U);
  EXPECT_EQ(count({0.0F, 0.0F, 0.0F}, {4.0F, 0.33F, 0.0F}, 0.1), 0U);
  EXPECT_EQ(count({3276.0F, 0.0F, 0.0F}, {2000.0F, 33.0F, 0.0F}, 0.1), 1U);
  EXPECT_EQ(count({3277.0F, 0.0F, 0.0F}, {2000.0F, 33.0F, 0.0F}, 0.1), 0U);  // beyond the map
  EXPECT_EQ(count({1e18F, 0.0F, 0.0F}, {8e17F, 3e16F, 0.0F}, 0.1), 0U);
  EXPECT_EQ(count({3e38F, 0.0F, 0.0F}, {2e38F, 3e37F, 0.0F}, 0.1), 0U);
}

// A column of a lidar with few rays around: the ground beside the line belongs to it, half-way to the next
// columns. Rings may begin each at an azimuth of its own.
TEST(SurfaceGaps, ReachHalfWayToTheNextColumns) {
  const double resolution = 0.1;
  const World ground = plane(Eigen::Vector3d::UnitZ(), -1.0);
  for (const bool are_aligned : {true, false}) {
    Dice dice(2);
    std::vector<Eigen::Vector3f> hits;
    const auto add_rings = [&](const std::vector<double>& elevations) {
      const auto more = rings(dice, ground, Eigen::Isometry3d::Identity(), elevations, 180, 30.0);
      hits.insert(hits.end(), more.begin(), more.end());
    };
    if (are_aligned) add_rings(evenly(-6.0, -9.0, 6));
    for (const double elevation : evenly(-6.0, -9.0, 6))
      if (!are_aligned) add_rings({elevation});
    SurfaceGaps gaps;
    ScanGrid grid;
    for (int x = -100; x < 100; ++x)
      for (int y = -100; y < 100; ++y) grid.set_free({x, y, -10}), grid.set_free({x, y, -11});
    spare_gaps(gaps.find(hits, {}, {.resolution = resolution}), nullptr, grid);
    int missed = 0;
    for (int i = 0; i < 3000; ++i) {
      const double range = dice.uniform(6.5, 9.2), azimuth = dice.uniform(0.0, 2 * M_PI);
      const Eigen::Vector2i cell(static_cast<int>(std::floor(range * std::cos(azimuth) / resolution)),
                                 static_cast<int>(std::floor(range * std::sin(azimuth) / resolution)));
      missed += grid.is_free({cell.x(), cell.y(), -10}) && grid.is_free({cell.x(), cell.y(), -11});
    }
    EXPECT_LE(missed, are_aligned ? 60 : 300);  // corners that steps of a voxel pass by
  }
}

}  // namespace surface_gaps_test
}  // namespace clearway
