#include "mapping/scans/compare_hits.hpp"

#include <gtest/gtest.h>

#include <unistd.h>

#include <filesystem>

#include "mapping/files/map_file.hpp"
#include "mapping/free_space_map.hpp"
#include "tests/worlds/random_map.hpp"

namespace clearway {
namespace compare_hits_test {

using worlds::Dice;

/// A wall 2 m ahead; the sensor is believed to stand this much too near to it.
Scan look_at_wall(double shift) {
  Scan scan;
  scan.map_from_sensor.translation() = Eigen::Vector3d(0.013 + shift, 0.013, 0.013);
  for (float y = -0.4F; y < 0.4F; y += 0.005F)
    for (float z = -0.4F; z < 0.4F; z += 0.005F) scan.points.emplace_back(2.0F, y, z);
  return scan;
}

/// Every hit looked up, cell by cell.
ScanAgreement slowly(const FusedTree& tree, const std::vector<Eigen::Vector3i>& hits) {
  const auto is = [&](const Eigen::Vector3i& cell, bool occupied) {
    CellCube cube;
    const FusedNode* leaf = tree.find_leaf(cell, cube);
    return leaf != nullptr && leaf->observed() && tree.isNodeOccupied(leaf) == occupied;
  };
  ScanAgreement result;
  for (const Eigen::Vector3i& cell : hits) {
    bool stable = is(cell, true);
    for (int axis = 0; axis < 3; ++axis)
      stable |= is(cell + Eigen::Vector3i::Unit(axis), true) || is(cell - Eigen::Vector3i::Unit(axis), true);
    result.looked_up += stable ? 1 : 0;
    result.called_free += stable && is(cell, false) ? 1 : 0;
    ++result.compared;
    result.amid_free += !stable && is(cell, false) ? 1 : 0;
  }
  return result;
}

TEST(CompareHits, CountsHitsInStablePlacesThatTheMapCalledFree) {
  for (unsigned seed = 0; seed < 6; ++seed) {
    Dice dice(seed);
    FusedTree tree(0.1);
    const auto cell = [&] {
      return Eigen::Vector3i(static_cast<int>(std::floor(dice.uniform(-8, 8))),
                             static_cast<int>(std::floor(dice.uniform(-8, 8))),
                             static_cast<int>(std::floor(dice.uniform(-8, 8))));
    };
    ScanGrid first, second;
    for (int i = 0; i < 800; ++i) first.set_free(cell());
    for (int i = 0; i < 300; ++i) first.set_occupied(cell());
    tree.update(first, Integration::safe);
    std::vector<Eigen::Vector3i> hits;
    for (int i = 0; i < 400; ++i)
      if (const Eigen::Vector3i at = cell(); second.set_occupied(at)) hits.push_back(at);
    const ScanAgreement expected = slowly(tree, hits);
    EXPECT_EQ(compare_hits(tree, second), expected);
    EXPECT_GT(expected.called_free, 0U);
    EXPECT_GT(expected.looked_up, expected.called_free);
    EXPECT_GT(expected.amid_free, 0U);
  }
}

TEST(CompareHits, AMapReportsItsShareAndAFileKeepsIt) {
  FreeSpaceMap map({.resolution = 0.02});
  map.insert(look_at_wall(0.0));
  EXPECT_EQ(map.snapshot().tree().agreement(), ScanAgreement{}) << "no map before the first scan";
  map.insert(look_at_wall(0.0));
  EXPECT_GT(map.snapshot().tree().agreement().looked_up, 500U);
  EXPECT_EQ(map.snapshot().tree().agreement().called_free, 0U);
  for (int i = 0; i < 3; ++i) map.insert(look_at_wall(0.06));  // frees beside the wall
  for (int i = 0; i < 3; ++i) map.insert(look_at_wall(-0.02));
  const ScanAgreement agreement = map.snapshot().tree().agreement();
  const std::filesystem::path folder =
      std::filesystem::temp_directory_path() / ("clearway_compare_hits_" + std::to_string(getpid()));
  save_map(map.snapshot(), folder);
  EXPECT_EQ(load_map(folder).tree().agreement(), agreement);
  std::filesystem::remove_all(folder);
}

}  // namespace compare_hits_test
}  // namespace clearway
