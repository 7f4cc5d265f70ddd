// Differences between maps, against voxel-by-voxel comparison.

#include "mapping/maps/map_difference.hpp"

#include <gtest/gtest.h>

#include "mapping/voxels/fused_tree.hpp"
#include "tests/worlds/random_map.hpp"

namespace clearway {
namespace map_difference_test {

TEST(MapDifference, CountsVoxelsByThePairOfTheirStates) {
  for (unsigned seed = 0; seed < 2; ++seed) {
    const Snapshot a = worlds::random_map(seed).snapshot(), b = worlds::random_map(seed + 50).snapshot();
    const MapDifference found = difference(a, b);
    std::map<std::pair<VoxelState, VoxelState>, std::size_t> expected;
    std::size_t evidence = 0;
    const int reach = 30;
    for (int x = -reach; x < reach; ++x) {
      for (int y = -reach; y < reach; ++y) {
        for (int z = -reach; z < reach; ++z) {
          const Eigen::Vector3d at = (Eigen::Vector3d(x, y, z).array() + 0.5) * 0.05;
          const Voxel here = a.voxel(at), there = b.voxel(at);
          if (here.state != there.state) {
            ++expected[{here.state, there.state}];
          } else if (here.observed != there.observed || here.volumes != there.volumes ||
                     (here.observed && here.log_odds != there.log_odds)) {
            ++evidence;
          }
        }
      }
    }
    EXPECT_EQ(found.states, expected);
    EXPECT_EQ(found.evidence, evidence);
    EXPECT_GT(expected.size(), 5U);
    EXPECT_GT(evidence, 0U);
    EXPECT_TRUE(found.any());
    EXPECT_EQ(found.volumes, (std::vector<std::string>{"tunnel", "dock"}));
  }
}

TEST(MapDifference, OfAMapWithItselfIsNone) {
  const Snapshot a = worlds::random_map(7).snapshot(), b = worlds::random_map(7).snapshot();
  EXPECT_FALSE(difference(a, b).any());
}

TEST(MapDifference, ComparesPaintByLabel) {
  const auto painted = [](const std::vector<std::string>& labels, const std::string& by) {
    FreeSpaceMap map({.resolution = 0.05});
    for (const std::string& label : labels) {
      const int volume = map.add_volume(label, {});
      if (label == by) map.paint(volume, {{0, 0, 0}, 0.3});
    }
    return map.snapshot();
  };
  EXPECT_FALSE(difference(painted({"a", "b"}, "b"), painted({"b", "a"}, "b")).any());
  const MapDifference other = difference(painted({"a", "b"}, "a"), painted({"a", "b"}, "b"));
  EXPECT_TRUE(other.states.empty());
  EXPECT_GT(other.evidence, 100U);
  EXPECT_EQ(other.volumes.size(), 2U);
  EXPECT_GT(difference(painted({"a"}, "a"), painted({"c"}, "c")).evidence, 100U);
}

TEST(MapDifference, NamesVolumesThatCountForOtherParts) {
  const auto painted_for = [](const std::vector<std::string>& parts) {
    FreeSpaceMap map({.resolution = 0.05});
    map.paint(map.add_volume("a", parts), {{0, 0, 0}, 0.3});
    return map.snapshot();
  };
  EXPECT_FALSE(difference(painted_for({"hand"}), painted_for({"hand"})).any());
  EXPECT_EQ(difference(painted_for({"hand"}), painted_for({"hand", "arm"})).volumes,
            std::vector<std::string>{"a"});
}

TEST(MapDifference, DoesNotCompareVoxelsOfDifferentSize) {
  const MapDifference found =
      difference(worlds::random_map(1, 0.05).snapshot(), worlds::random_map(1, 0.1).snapshot());
  EXPECT_TRUE(found.resolution);
  EXPECT_TRUE(found.states.empty());
  EXPECT_TRUE(found.any());
}

}  // namespace map_difference_test
}  // namespace clearway
