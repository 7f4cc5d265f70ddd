// Points that are no hits, as they may be the robot's: nothing is freed around them.
#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <set>

#include "mapping/free_space_map.hpp"
#include "mapping/scans/safe_scan.hpp"
#include "tests/worlds/random_map.hpp"

namespace clearway {
namespace taken_out_points_test {

using worlds::Cell;
constexpr double resolution = 0.02;

Cell cell_of(const Eigen::Vector3d& point) { return worlds::cell_of(point, resolution); }

std::set<Cell> free_cells(const FreeSpaceMap& map) {
  return worlds::cells_in(map.snapshot(), VoxelState::seen_free);
}

/// A wall 2 m ahead and before it, 1 m ahead, a pole.
struct Look {
  Scan wall;
  std::vector<Eigen::Vector3f> pole;
};

Look look_from(double x, double y) {
  Look look;
  look.wall.map_from_sensor.translation() = Eigen::Vector3d(x, y, 0.0);
  for (double to_y = -0.5; to_y < 0.5; to_y += 0.004) {
    for (double to_z = -0.3; to_z < 0.3; to_z += 0.008) {
      const Eigen::Vector3d wall = Eigen::Vector3d(2.0, to_y, to_z) - look.wall.map_from_sensor.translation();
      const double share = (1.0 - x) / (2.0 - x);
      const bool meets = std::abs(y + share * wall.y()) < 0.01;
      if (meets)
        look.pole.push_back((share * wall).cast<float>());
      else
        look.wall.points.push_back(wall.cast<float>());
    }
  }
  return look;
}

Scan whole(const Look& look) {
  Scan scan = look.wall;
  scan.points.insert(scan.points.end(), look.pole.begin(), look.pole.end());
  return scan;
}

Scan without_pole(const Look& look) {
  Scan scan = look.wall;
  scan.taken_out = look.pole;
  return scan;
}

std::set<VoxelState> states_of_pole(const FreeSpaceMap& map) {
  const Snapshot now = map.snapshot();
  std::set<VoxelState> states;
  for (double z = -0.1; z < 0.1; z += 0.004)
    for (const double y : {-0.009, -0.003, 0.003, 0.009}) states.insert(now.state({1.001, y, z}));
  return states;
}

/// The robot stood beside a pole, and its points were taken out with the robot's own.
TEST(TakenOutPoints, WhatStandsThereStaysAsItWas) {
  FreeSpaceMap occupied({.resolution = resolution}), filtered({.resolution = resolution}),
      unknown({.resolution = resolution});
  for (int i = 0; i < 30; ++i)
    for (FreeSpaceMap* map : {&occupied, &filtered}) map->insert(whole(look_from(0.0, 0.0)));
  ScanFilter filter;
  filter.bodies = {{{1.0, 0.0, -1.0}, {1.0, 0.0, 1.0}, 0.03}};
  for (int i = 0; i < 60; ++i) {
    const Look look = look_from(0.003 * (i % 7), 0.004 * (i % 11));
    for (FreeSpaceMap* map : {&occupied, &unknown}) map->insert(without_pole(look));
    filtered.insert(whole(look), filter);
  }
  EXPECT_EQ(states_of_pole(occupied), std::set{VoxelState::occupied});
  EXPECT_EQ(states_of_pole(filtered), std::set{VoxelState::occupied});
  EXPECT_EQ(states_of_pole(unknown), std::set{VoxelState::unknown});
}

/// A robot that passes through free space leaves it free, while scans disagree too.
TEST(TakenOutPoints, WhatWasFreeStaysFree) {
  FreeSpaceMap map({.resolution = resolution});
  Look through = look_from(0.0, 0.0);
  for (const Eigen::Vector3f& point : through.pole) through.wall.points.push_back(2.0F * point);
  map.insert(through.wall);
  const std::set<Cell> before = free_cells(map);
  for (int i = 0; i < 20; ++i) {
    Scan near = through.wall;  // hits what was free: the scans disagree
    for (Eigen::Vector3f& point : near.points) point *= i % 2 == 0 ? 0.9F : 1.0F;
    near.points.resize(near.points.size() / 2);
    near.taken_out = through.pole;
    map.insert(near);
  }
  EXPECT_TRUE(before.contains(cell_of({1.0, 0.0, 0.0})));
  EXPECT_EQ(states_of_pole(map), std::set{VoxelState::seen_free});
}

/// Against the definition: of what the other rays free, what lies in the band.
TEST(TakenOutPoints, NothingElseIsSpared) {
  std::size_t spared_cells = 0;
  for (unsigned seed = 0; seed < 6; ++seed) {
    worlds::Dice dice(seed);
    const Scan scan = worlds::random_scan(dice, 300);
    Scan with = scan;
    for (int i = 0; i < 60; ++i) with.taken_out.push_back((0.9 * dice.point(1.0)).cast<float>());
    FreeSpaceMap plain({.resolution = resolution}), spared({.resolution = resolution});
    plain.insert(scan);
    EXPECT_EQ(spared.insert(with).inserted, scan.points.size());
    std::set<Cell> band;  // grown cell by cell
    for (const Eigen::Vector3f& point : with.taken_out)
      band.insert(cell_of(scan.map_from_sensor * point.cast<double>()));
    for (const GrowthStep step : growth_of(SafeMargins{}.band, resolution)) {
      const std::set<Cell> cells = band;
      for (const Cell& c : cells)
        for (int x = -1; x <= 1; ++x)
          for (int y = -1; y <= 1; ++y)
            for (int z = -1; z <= 1; ++z)
              if (std::abs(x) + std::abs(y) + std::abs(z) <= 1 + static_cast<int>(step))
                band.insert({c[0] + x, c[1] + y, c[2] + z});
    }
    std::set<Cell> expected = free_cells(plain);
    for (const Cell& cell : band) spared_cells += expected.erase(cell);
    EXPECT_EQ(free_cells(spared), expected) << seed;
  }
  EXPECT_GT(spared_cells, 100U);
}

TEST(TakenOutPoints, AreNothingToCompatibleMaps) {
  FreeSpaceMap plain({.resolution = resolution, .integration = Integration::compatible}),
      other({.resolution = resolution, .integration = Integration::compatible});
  const Look look = look_from(0.0, 0.01);
  plain.insert(look.wall);
  other.insert(without_pole(look));
  EXPECT_EQ(free_cells(plain), free_cells(other));
}

TEST(TakenOutPoints, ThoseThatAreNowhereSpareNothing) {
  FreeSpaceMap plain({.resolution = resolution}), other({.resolution = resolution});
  const Look look = look_from(0.0, 0.01);
  Scan scan = look.wall;
  plain.insert(scan);
  scan.taken_out = {{NAN, 0.0F, 0.0F}, {1e30F, 0.0F, 0.0F}, {0.0F, HUGE_VALF, 0.0F}};
  other.insert(scan);
  EXPECT_EQ(free_cells(plain), free_cells(other));
}

}  // namespace taken_out_points_test
}  // namespace clearway
