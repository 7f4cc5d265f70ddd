// Our exports in the hands of Debian's OctoMap programs (package octomap-tools).

#include <gtest/gtest.h>
#include <octomap/OcTree.h>

#include <cstdlib>
#include <fstream>
#include <set>
#include <tuple>

#include "mapping/files/map_file.hpp"
#include "mapping/voxels/fused_tree.hpp"
#include "tests/worlds/random_map.hpp"
#include "tests/worlds/temporary_folder.hpp"

namespace clearway {
namespace octomap_tools_test {

namespace fs = std::filesystem;

class OctomapTools : public ::testing::Test {
 protected:
  void SetUp() override {
    if (!has("convert_octree") || !has("compare_octrees") || !has("bt2vrml")) {
      GTEST_SKIP() << "Debian's octomap-tools are not on this machine";
    }
  }
  static bool has(const std::string& program) { return run("command -v " + program) == 0; }
  static int run(const std::string& command) { return std::system((command + " >/dev/null 2>&1").c_str()); }

  /// 1 mm steps of the centres of occupied voxels at the finest resolution.
  using Cells = std::set<std::tuple<int, int, int>>;
  static Cells occupied(const Snapshot& map) {
    Cells cells;
    map.visit_leaves([&](const Voxel& leaf) {
      if (leaf.state != VoxelState::occupied && leaf.state != VoxelState::conflict) return;
      const double half = (leaf.size - map.resolution()) / 2;
      for (double x = -half; x < half + 1e-6; x += map.resolution()) {
        for (double y = -half; y < half + 1e-6; y += map.resolution()) {
          for (double z = -half; z < half + 1e-6; z += map.resolution()) {
            const Eigen::Vector3d at = 1e3 * (leaf.center + Eigen::Vector3d(x, y, z));
            cells.emplace(std::lround(at.x()), std::lround(at.y()), std::lround(at.z()));
          }
        }
      }
    });
    return cells;
  }

  const TemporaryFolder folder_;
  const Snapshot map_ = worlds::random_map(11).snapshot();

  std::string path(const std::string& name) const { return (folder_ / name).string(); }
};

TEST_F(OctomapTools, ConvertOctreeTurnsOurColourTreeIntoABinaryTreeOfTheSameObstacles) {
  export_map(map_, folder_ / "colour.ot");
  ASSERT_EQ(run("convert_octree " + path("colour.ot") + " " + path("converted.bt")), 0);
  const Cells expected = occupied(map_);
  EXPECT_GT(expected.size(), 100U);
  EXPECT_EQ(occupied(load_map(folder_ / "converted.bt")), expected);
}

TEST_F(OctomapTools, ConvertOctreeReadsTheObstaclesOfOurMap) {
  save_map(map_, folder_ / "map");
  ASSERT_EQ(run("convert_octree " + path("map/map.ot") + " " + path("converted.bt")), 0);
  const Snapshot converted = load_map(folder_ / "converted.bt");
  EXPECT_EQ(converted.resolution(), map_.resolution());
  EXPECT_EQ(occupied(converted), occupied(map_));
}

TEST_F(OctomapTools, ConvertOctreeReadsOurBinaryTree) {
  export_map(map_, folder_ / "binary.bt");
  ASSERT_EQ(run("convert_octree " + path("binary.bt") + " " + path("converted.ot")), 0);
  const Snapshot converted = load_map(folder_ / "converted.ot");
  EXPECT_EQ(occupied(converted), occupied(map_));
  const VoxelCounts ours = map_.counts();
  EXPECT_EQ(converted.counts().seen_free, ours.seen_free + ours.painted);
  ASSERT_EQ(run("compare_octrees " + path("converted.ot") + " " + path("converted.ot")), 0);
}

TEST_F(OctomapTools, Bt2vrmlDrawsABoxForEachOccupiedLeafOfOurBinaryTree) {
  export_map(map_, folder_ / "binary.bt");
  ASSERT_EQ(run("bt2vrml " + path("binary.bt")), 0);
  std::ifstream drawing(folder_ / "binary.bt.wrl");
  std::size_t boxes = 0;
  for (std::string line; std::getline(drawing, line);) boxes += line.find("Box") != std::string::npos;
  octomap::OcTree tree(0.1);
  ASSERT_TRUE(tree.readBinary(path("binary.bt")));
  std::size_t leaves = 0;
  for (auto leaf = tree.begin_leafs(), end = tree.end_leafs(); leaf != end; ++leaf) {
    leaves += tree.isNodeOccupied(*leaf);
  }
  EXPECT_GT(leaves, 100U);
  EXPECT_EQ(boxes, leaves);
}

}  // namespace octomap_tools_test
}  // namespace clearway
