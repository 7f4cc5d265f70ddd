// What a page draws of a map, against the voxels one by one.

#include "apps/pages/drawn_voxels.hpp"

#include <gtest/gtest.h>

#include <map>
#include <set>
#include <tuple>

#include "mapping/voxels/fused_tree.hpp"
#include "tests/worlds/random_map.hpp"

namespace clearway {
namespace drawn_voxels_test {

using Cell = std::tuple<int, int, int>;

/// The voxels of each state, from the map's origin.
std::map<std::string, std::set<Cell>> voxels_by_state(const MapLeaves& map) {
  std::map<std::string, std::set<Cell>> voxels;
  map.visit([&](const MapLeaf& leaf) {
    for (int x = 0; x < leaf.edge; ++x)
      for (int y = 0; y < leaf.edge; ++y)
        for (int z = 0; z < leaf.edge; ++z)
          voxels[std::string(to_string(leaf.state))].emplace(leaf.corner.x() + x, leaf.corner.y() + y,
                                                             leaf.corner.z() + z);
  });
  return voxels;
}

/// The voxels that are drawn.
std::set<Cell> drawn(const PageVoxels& voxels) {
  std::set<Cell> cells;
  const int unit = 1 << voxels.cells.cell_level();
  const auto fill = [&](int x0, int y0, int z0, int side) {
    for (int x = 0; x < side; ++x)
      for (int y = 0; y < side; ++y)
        for (int z = 0; z < side; ++z)
          EXPECT_TRUE(
              cells.emplace(x0 + x - kOriginVoxel, y0 + y - kOriginVoxel, z0 + z - kOriginVoxel).second);
  };
  for (const VoxelBricks::Cube& cube : voxels.cells.cubes()) {
    const VoxelBricks::Cell low = VoxelBricks::low_of(cube.code);
    if (cube.bits == VoxelBricks::Cube::full) {
      fill(low[0], low[1], low[2], 1 << cube.level);
      continue;
    }
    for (int i = 0; i < 512; ++i)
      if ((voxels.cells.bits(cube)[static_cast<std::size_t>(i / 64)] >> (i % 64) & 1U) != 0)
        fill(low[0] + i % 8 * unit, low[1] + i / 8 % 8 * unit, low[2] + i / 64 * unit, unit);
  }
  return cells;
}

std::set<Cell> coarse(const std::set<Cell>& voxels, int unit, bool any) {
  std::map<Cell, int> inside;
  for (const auto& [x, y, z] : voxels) ++inside[{x & -unit, y & -unit, z & -unit}];
  std::set<Cell> result;
  for (const auto& [low, count] : inside) {
    if (!any && count < unit * unit * unit) continue;
    for (int x = 0; x < unit; ++x)
      for (int y = 0; y < unit; ++y)
        for (int z = 0; z < unit; ++z)
          result.emplace(std::get<0>(low) + x, std::get<1>(low) + y, std::get<2>(low) + z);
  }
  return result;
}

TEST(DrawnVoxels, OfASmallMapAreAllOfThem) {
  for (unsigned seed = 0; seed < 4; ++seed) {
    const MapLeaves map(worlds::random_map(seed).snapshot());
    auto voxels = voxels_by_state(map);
    for (const PageVoxels& set : drawn_voxels(map)) {
      EXPECT_EQ(set.cells.cell_level(), 0);
      EXPECT_EQ(drawn(set), voxels[set.state]);
      EXPECT_EQ(set.count, voxels[set.state].size());
    }
  }
}

/// Nothing is drawn free or painted that is not, and nothing that blocks is left out.
TEST(DrawnVoxels, WithTooMuchSurfaceAreCoarserButHideNoObstacle) {
  for (unsigned seed = 0; seed < 4; ++seed) {
    const MapLeaves map(worlds::random_map(seed, 0.04).snapshot());
    auto voxels = voxels_by_state(map);
    for (const std::uint64_t most : {4000, 1000, 200}) {
      for (const PageVoxels& set : drawn_voxels(map, most)) {
        const bool any = set.state == "occupied" || set.state == "conflict";
        EXPECT_LE(count_faces(set.cells), most) << set.state;
        EXPECT_EQ(drawn(set), coarse(voxels[set.state], 1 << set.cells.cell_level(), any)) << set.state;
        EXPECT_EQ(set.count, voxels[set.state].size());
      }
    }
  }
}

/// Single voxels, 16 apart: a brick each, more than are kept as single voxels.
TEST(DrawnVoxels, OfADifferenceVanishNowhereHoweverCoarse) {
  const auto tree = std::make_shared<FusedTree>(0.1), empty = std::make_shared<FusedTree>(0.1);
  const auto key = [](int i) { return static_cast<octomap::key_type>(32768 + 2 * i); };  // isolated
  for (int x = 0; x < 24; ++x)
    for (int y = 0; y < 24; ++y)
      for (int z = 0; z < 4; ++z) tree->set_observed({key(x), key(y), key(z)}, 2.0F);
  tree->finish();
  empty->finish();
  const Snapshot with(tree, {}), without(empty, {});
  const MapLeaves difference = MapLeaves::difference(with, without);
  std::uint64_t counted = 0;
  for (const PageVoxels& voxels : drawn_voxels(difference, 200, true)) {
    counted += voxels.count;
    EXPECT_EQ(voxels.count > 0, !drawn(voxels).empty()) << voxels.state;
  }
  EXPECT_EQ(counted, 24u * 24u * 4u);
}

TEST(DrawnVoxels, OfAThinCloudStayFewerThanTheirVoxels) {
  auto tree = std::make_shared<FusedTree>(0.01);
  constexpr int side = 80;
  for (int x = 0; x < side; ++x)
    for (int y = 0; y < side; ++y)
      for (int z = 0; z < side; ++z)
        tree->set_observed(
            {static_cast<octomap::key_type>(32000 + 16 * x), static_cast<octomap::key_type>(32000 + 16 * y),
             static_cast<octomap::key_type>(32000 + 16 * z)},
            1.0F);
  tree->finish();
  const std::vector<PageVoxels> sets = drawn_voxels(MapLeaves(Snapshot(tree, {})));
  const PageVoxels& occupied = sets.at(1);
  EXPECT_EQ(occupied.count, static_cast<std::uint64_t>(side * side * side));
  EXPECT_GT(occupied.cells.cell_level(), 0);
  EXPECT_LE(occupied.cells.bricks(), 400'000U);
  EXPECT_LE(count_faces(occupied.cells), most_faces_shown);
}

}  // namespace drawn_voxels_test
}  // namespace clearway
