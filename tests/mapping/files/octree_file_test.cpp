// Our own .ot format and foreign octrees: round trips against stock OctoMap, and damage.

#include "mapping/files/octree_file.hpp"

#include <gtest/gtest.h>
#include <octomap/ColorOcTree.h>
#include <octomap/OcTree.h>

#include <cmath>
#include <cstdint>
#include <locale>
#include <memory>
#include <sstream>

#include "mapping/files/map_file.hpp"
#include "mapping/files/octree_check.hpp"
#include "mapping/free_space_map.hpp"
#include "mapping/voxels/fused_tree.hpp"
#include "tests/worlds/random_map.hpp"

namespace clearway {
namespace octree_file_test {

using worlds::Dice;

std::string own_file(unsigned seed, int points = 20) {
  const Snapshot map = worlds::random_map(seed, 0.2, 1, points).snapshot();
  return format_fused_tree(map.tree(), map.volumes());
}

octomap::OcTree stock_tree(unsigned seed, double resolution = 0.1) {
  octomap::OcTree tree(resolution);
  Dice dice(seed);
  for (int i = 0; i < 300; ++i) {
    const Eigen::Vector3d point = dice.point(1.0);
    tree.updateNode(point.x(), point.y(), point.z(), dice.whole(0, 1) == 0);
  }
  return tree;
}

std::string stock_text(const octomap::AbstractOcTree& tree) {
  std::ostringstream stream;
  tree.write(stream);
  return std::move(stream).str();
}

std::string stock_binary(octomap::OcTree& tree) {
  std::ostringstream stream;
  ::testing::internal::CaptureStderr();
  tree.writeBinary(stream);
  ::testing::internal::GetCapturedStderr();
  return std::move(stream).str();
}

bool is_refused(const std::string& bytes) {
  try {
    parse_octree(bytes, "test.ot");
  } catch (const DamagedFile&) {
    return true;
  }
  return false;
}

TEST(OctreeFile, OurFileReadsBackEqualAndWritesTheSameBytesAgain) {
  for (unsigned seed = 0; seed < 10; ++seed) {
    const Snapshot map = worlds::random_map(seed, 0.1 / 3.0).snapshot();
    const std::string bytes = format_fused_tree(map.tree(), map.volumes());
    const OctreeContent content = parse_octree(bytes, "map.ot");
    EXPECT_TRUE(*content.tree == map.tree());
    EXPECT_EQ(content.tree->getResolution(), 0.1 / 3.0);
    EXPECT_TRUE(content.has_volumes);
    EXPECT_EQ(format_fused_tree(*content.tree, content.volumes), bytes);
  }
}

/// As std::locale::global(std::locale("en_US.UTF-8")) has them in many programs with windows.
struct GroupedDigits : std::numpunct<char> {
  char do_thousands_sep() const override { return ','; }
  std::string do_grouping() const override { return "\3"; }
};

TEST(OctreeFile, IsTheSameInAProgramWhoseNumbersAreGrouped) {
  FreeSpaceMap map({.resolution = 0.05});
  std::vector<Eigen::Vector3f> points;
  for (int i = 0; i < 70; ++i)
    for (int j = 0; j < 70; ++j)
      points.emplace_back(2.0F, 0.02F * static_cast<float>(i - 35), 0.02F * static_cast<float>(j - 35));
  for (int scan = 1; scan <= 20; ++scan)
    map.insert({.time = 1000.0 * scan, .sensor = "lidar", .points = points});
  const Snapshot snapshot = map.snapshot();
  ASSERT_GT(snapshot.tree().agreement().looked_up, 999U);
  const std::string bytes = format_fused_tree(snapshot.tree(), snapshot.volumes(), snapshot.seen());
  const std::locale before = std::locale::global(std::locale(std::locale::classic(), new GroupedDigits));
  EXPECT_TRUE(format_fused_tree(snapshot.tree(), snapshot.volumes(), snapshot.seen()) == bytes);
  std::locale::global(before);
}

/// Before 1.0 a header of numbers; OctoMap still reads it, and so do we, to the same tree.
TEST(OctreeFile, BinaryFilesOfBeforeOneAreReadAsOctoMapReadsThem) {
  octomap::OcTree tree = stock_tree(5);
  const std::string bytes = stock_binary(tree);
  const auto word = [](const auto& number) {
    return std::string(reinterpret_cast<const char*>(&number), sizeof(number));
  };
  const auto old = [&](std::int32_t kind, double resolution, std::size_t nodes) {
    return word(kind) + word(resolution) + word(static_cast<std::uint32_t>(nodes)) +
           bytes.substr(bytes.find("\ndata\n") + 6);
  };
  const std::string file = old(3, 0.1, tree.size());
  std::istringstream stream(file);
  octomap::OcTree theirs(0.5);
  ASSERT_TRUE(theirs.readBinary(stream));
  EXPECT_TRUE(theirs == tree);
  const auto ours = parse_octree(file, "old.bt").tree, modern = parse_octree(bytes, "new.bt").tree;
  EXPECT_TRUE(*ours == *modern);
  EXPECT_EQ(ours->getResolution(), 0.1);
  EXPECT_TRUE(is_refused(old(3, 0.0, tree.size())));
  EXPECT_TRUE(is_refused(old(3, std::nan(""), tree.size())));
  EXPECT_TRUE(is_refused(old(4, 0.1, tree.size())));
  EXPECT_TRUE(is_refused(old(3, 0.1, tree.size() + 1)));
  EXPECT_TRUE(is_refused(file.substr(0, 12)));
  EXPECT_TRUE(is_refused(file.substr(0, file.size() - 1)));
}

TEST(OctreeFile, AnEmptyMapIsAFileToo) {
  FreeSpaceMap map({.resolution = 0.25});
  map.add_volume("nothing yet", {"tool"});
  const Snapshot snapshot = map.snapshot();
  const OctreeContent content =
      parse_octree(format_fused_tree(snapshot.tree(), snapshot.volumes()), "map.ot");
  EXPECT_EQ(content.tree->size(), 0U);
  EXPECT_EQ(content.volumes.at(0).label, "nothing yet");
  for (const std::string& bytes : {format_color_tree(snapshot.tree()), format_binary_tree(snapshot.tree())}) {
    EXPECT_EQ(parse_octree(bytes, "map.ot").tree->size(), 0U);
  }
}

/// What many looks say takes as many to be taken back, loaded or not.
TEST(OctreeFile, TheClampingTravelsWithTheMap) {
  FreeSpaceMap map({.resolution = 0.1, .min_probability = 0.01, .max_probability = 0.999});
  Scan scan;
  scan.points = {{0.55F, 0.05F, 0.05F}};
  for (int i = 0; i < 12; ++i) map.insert(scan);
  const Snapshot snapshot = map.snapshot();
  const std::string bytes = format_fused_tree(snapshot.tree(), {});
  const OctreeContent content = parse_octree(bytes, "map.ot");
  EXPECT_EQ(content.tree->getClampingThresMaxLog(), snapshot.tree().getClampingThresMaxLog());
  EXPECT_EQ(content.tree->getClampingThresMinLog(), snapshot.tree().getClampingThresMinLog());
  EXPECT_GT(content.tree->getClampingThresMaxLog(), 6.0F);
  EXPECT_EQ(format_fused_tree(*content.tree, {}), bytes);
  EXPECT_EQ(own_file(1).find("clamped"), std::string::npos) << "OctoMap's own needs no word";
}

TEST(OctreeFile, TheOccupancyThresholdTravelsWithTheMap) {
  FreeSpaceMap map({.resolution = 0.1, .occupied_probability = 0.9});
  Scan scan;
  scan.points = {{0.55F, 0.05F, 0.05F}};
  map.insert(scan);
  const Snapshot snapshot = map.snapshot();
  const OctreeContent content = parse_octree(format_fused_tree(snapshot.tree(), {}), "map.ot");
  EXPECT_EQ(content.tree->getOccupancyThresLog(), snapshot.tree().getOccupancyThresLog());
}

TEST(OctreeFile, OctoMapsOwnReaderOpensOurFileWithItsEvidence) {
  const Snapshot map = worlds::random_map(2).snapshot();
  std::istringstream stream(format_fused_tree(map.tree(), map.volumes()));
  ::testing::internal::CaptureStderr();
  const std::unique_ptr<octomap::AbstractOcTree> tree(octomap::AbstractOcTree::read(stream));
  ::testing::internal::GetCapturedStderr();
  auto* read = dynamic_cast<octomap::ColorOcTree*>(tree.get());
  ASSERT_NE(read, nullptr);
  EXPECT_EQ(read->size(), map.tree().size());
  EXPECT_EQ(read->getResolution(), map.resolution());
  std::size_t occupied = 0;
  map.visit_leaves([&](const Voxel& voxel) {
    const auto* node = read->search(voxel.center.x(), voxel.center.y(), voxel.center.z());
    ASSERT_NE(node, nullptr);
    const bool blocks = voxel.state == VoxelState::occupied || voxel.state == VoxelState::conflict;
    EXPECT_EQ(read->isNodeOccupied(node), blocks);
    if (voxel.observed) {
      EXPECT_EQ(static_cast<double>(node->getLogOdds()), voxel.log_odds);
    }
    occupied += blocks;
  });
  EXPECT_GT(occupied, 100U);
}

/// As they were written before maps named themselves ColorOcTree.
TEST(OctreeFile, NoStockProgramTakesWhatBlocksForFreeWhateverTheThreshold) {
  for (const float threshold : {-0.847F, 0.0F, 0.4F}) {
    FusedTree tree(0.1);
    tree.set_occupied_log_odds(threshold);
    tree.set_observed({32768, 32768, 32768}, -0.5F);
    tree.set_observed({32769, 32768, 32768}, -2.0F);
    tree.finish();
    const octomap::OcTreeKey key(32768, 32768, 32768);
    const std::string bytes = format_fused_tree(tree, {});
    std::istringstream stream(bytes);
    ::testing::internal::CaptureStderr();
    const std::unique_ptr<octomap::AbstractOcTree> stock(octomap::AbstractOcTree::read(stream));
    ::testing::internal::GetCapturedStderr();
    const auto* color = dynamic_cast<const octomap::ColorOcTree*>(stock.get());
    if (tree.state(*tree.search(key)) == VoxelState::occupied && color != nullptr) {
      EXPECT_TRUE(color->isNodeOccupied(color->search(key))) << threshold;
    }
    EXPECT_EQ(color == nullptr, threshold < 0.0F);
    const auto back = parse_octree(bytes, "m.ot");
    EXPECT_TRUE(*back.tree == tree) << threshold;
    EXPECT_EQ(back.tree->getOccupancyThresLog(), threshold);
  }
}

TEST(OctreeFile, FilesThatNameOurOwnTypeAreReadAsBefore) {
  const Snapshot map = worlds::random_map(4).snapshot();
  std::string bytes = format_fused_tree(map.tree(), map.volumes());
  const auto seal = bytes.find('\n') + 1, rest = bytes.find('\n', seal) + 1;
  const std::string before = bytes.substr(0, seal);
  std::string after = bytes.substr(rest);
  after.erase(after.find(fused_nodes_comment), fused_nodes_comment.size());
  after.replace(after.find("id ColorOcTree"), 14, "id ClearwayFusedTree");
  const OctreeContent content = parse_octree(before + seal_line(before, after) + after, "map.ot");
  EXPECT_TRUE(*content.tree == map.tree());
  EXPECT_TRUE(content.has_volumes);
  EXPECT_EQ(format_fused_tree(*content.tree, content.volumes), bytes);
}

TEST(OctreeFile, EveryTruncationOfOurFileIsRefused) {
  const std::string bytes = own_file(1);
  for (std::size_t length = 0; length < bytes.size(); ++length)
    ASSERT_TRUE(is_refused(bytes.substr(0, length)));
  EXPECT_TRUE(is_refused(bytes + '\0'));
  EXPECT_FALSE(is_refused(bytes));
}

TEST(OctreeFile, EveryFlippedBitInOurFileIsRefused) {
  const std::string bytes = own_file(1, 2);
  for (std::size_t bit = 0; bit < 8 * std::min<std::size_t>(bytes.size(), 1000); ++bit) {  // header, volumes
    std::string damaged = bytes;
    damaged[bit / 8] ^= static_cast<char>(1U << (bit % 8));
    ASSERT_TRUE(is_refused(damaged)) << bit;
  }
  Dice dice(3);
  for (int i = 0; i < 3000; ++i) {
    std::string damaged = bytes;
    for (int flips = dice.whole(1, 4); flips > 0; --flips) {
      damaged[static_cast<std::size_t>(dice.whole(0, static_cast<int>(bytes.size()) - 1))] ^=
          static_cast<char>(1U << dice.whole(0, 7));
    }
    ASSERT_TRUE(damaged == bytes || is_refused(damaged));
  }
}

TEST(OctreeFile, ForeignTreesBecomeObservedVoxelsOfTheSameLogOdds) {
  octomap::OcTree stock = stock_tree(4, 0.1 / 3.0);
  stock.prune();
  std::ostringstream precise;
  precise.precision(17);
  stock.write(precise);
  const OctreeContent content = parse_octree(precise.str(), "stock.ot");
  EXPECT_FALSE(content.has_volumes);
  EXPECT_EQ(content.tree->getNumLeafNodes(), stock.getNumLeafNodes());
  auto it = content.tree->begin_leafs();
  for (auto leaf = stock.begin_leafs(), end = stock.end_leafs(); leaf != end; ++leaf, ++it) {
    ASSERT_EQ(it.getKey(), leaf.getKey());
    ASSERT_EQ(it->getLogOdds(), leaf->getLogOdds());
    ASSERT_TRUE(it->observed());
  }
}

TEST(OctreeFile, ForeignBinaryTreesKeepFreeAndOccupied) {
  octomap::OcTree stock = stock_tree(5);
  const OctreeContent content = parse_octree(stock_binary(stock), "stock.bt");
  for (auto leaf = stock.begin_leafs(), end = stock.end_leafs(); leaf != end; ++leaf) {
    const Snapshot map(content.tree, {});
    const bool occupied = map.state({leaf.getX(), leaf.getY(), leaf.getZ()}) == VoxelState::occupied;
    ASSERT_EQ(occupied, stock.isNodeOccupied(*leaf));
  }
}

TEST(OctreeFile, DamagedForeignFilesNeverCrashAndTruncatedOnesAreRefused) {
  octomap::OcTree stock = stock_tree(6);
  octomap::ColorOcTree color(0.1);
  for (int i = 0; i < 50; ++i) color.updateNode(0.1 * i, 0.05, 0.05, true);
  for (const std::string& bytes : {stock_text(stock), stock_text(color), stock_binary(stock)}) {
    ASSERT_FALSE(is_refused(bytes));
    ASSERT_TRUE(is_refused(bytes + '\0'));
    for (std::size_t length = 0; length < bytes.size(); ++length)
      ASSERT_TRUE(is_refused(bytes.substr(0, length)));
    Dice dice(7);
    for (int i = 0; i < 2000; ++i) {
      std::string damaged = bytes;
      for (int flips = dice.whole(1, 8); flips > 0; --flips) {
        damaged[static_cast<std::size_t>(dice.whole(0, static_cast<int>(bytes.size()) - 1))] ^=
            static_cast<char>(1U << dice.whole(0, 7));
      }
      is_refused(damaged);  // either answer, but no crash
    }
  }
}

TEST(OctreeFile, ChainsAndRubbishThatOverflowStockReadersAreRefused) {
  const std::string text = "# Octomap OcTree file\nid OcTree\nsize 100000\nres 0.1\ndata\n";
  const std::string binary = "# Octomap OcTree binary file\nid OcTree\nsize 100000\nres 0.1\ndata\n";
  std::string chain, binary_chain;
  for (int i = 0; i < 100000; ++i) {
    chain += std::string("\0\0\0\0\1", 5);
    binary_chain += std::string("\3\0", 2);
  }
  EXPECT_TRUE(is_refused(text + chain));
  EXPECT_TRUE(is_refused(binary + binary_chain));
  EXPECT_TRUE(is_refused(text + std::string(1000000, '\xff')));
  EXPECT_TRUE(is_refused(binary + std::string(1000000, '\xff')));
  EXPECT_TRUE(is_refused(binary + std::string(100000, '\0')));
}

TEST(OctreeFile, SixteenLevelsAreReadAndSeventeenRefused) {
  for (const int levels : {15, 16, 17}) {
    const std::string rest = "\nid OcTree\nsize " + std::to_string(levels + 1) + "\nres 0.1\ndata\n";
    std::string text = "# Octomap OcTree file" + rest, binary = "# Octomap OcTree binary file" + rest;
    for (int i = 0; i < levels; ++i) {
      text += std::string("\0\0\0\0\1", 5);
      binary += std::string(i + 1 < levels ? "\3\0" : "\1\0", 2);
    }
    text += std::string("\0\0\0\0\0", 5);
    EXPECT_EQ(is_refused(text), levels > 16) << levels;
    EXPECT_EQ(is_refused(binary), levels > 16) << levels;
  }
}

TEST(OctreeFile, RefusesAHeaderThatMakesNoSense) {
  const auto file = [](const std::string& id, const std::string& size, const std::string& res) {
    return "# Octomap OcTree file\nid " + id + "\nsize " + size + "\nres " + res + "\ndata\n" +
           std::string("\0\0\0\0\0", 5);
  };
  EXPECT_FALSE(is_refused(file("OcTree", "1", "0.1")));
  for (const char* res : {"0", "-1", "nan", "inf", "1e-300", "1e300", "0.1x", ""}) {
    EXPECT_TRUE(is_refused(file("OcTree", "1", res))) << res;
  }
  for (const char* size : {"0", "2", "-1", "99999999999999999999", "x"}) {
    EXPECT_TRUE(is_refused(file("OcTree", size, "0.1"))) << size;
  }
  for (const char* line : {"", "  ", "made by hand", "# a comment"})  // which OctoMap skips
    EXPECT_FALSE(is_refused(file("OcTree \n" + std::string(line), "1\r", "0.1\r"))) << line;
  EXPECT_TRUE(is_refused(file("OcTree\n\x01\x02", "1", "0.1")));
  EXPECT_TRUE(is_refused(file("CountingOcTree", "1", "0.1")));
  EXPECT_TRUE(is_refused(file("ClearwayFusedTree", "1", "0.1")));
  EXPECT_TRUE(is_refused(""));
}

TEST(OctreeFile, AColorTreeShowsStockProgramsWhatIsOccupied) {
  const Snapshot map = worlds::random_map(8).snapshot();
  std::istringstream stream(format_color_tree(map.tree()));
  ::testing::internal::CaptureStderr();
  const std::unique_ptr<octomap::AbstractOcTree> read(octomap::AbstractOcTree::read(stream));
  ::testing::internal::GetCapturedStderr();
  auto* color = dynamic_cast<octomap::ColorOcTree*>(read.get());
  ASSERT_NE(color, nullptr);
  map.visit_leaves([&](const Voxel& voxel) {
    const auto* node = color->search(voxel.center.x(), voxel.center.y(), voxel.center.z());
    ASSERT_NE(node, nullptr);
    const bool blocked = voxel.state == VoxelState::occupied || voxel.state == VoxelState::conflict;
    ASSERT_EQ(color->isNodeOccupied(node), blocked);
    ASSERT_EQ(node->getColor().r > 200, voxel.state == VoxelState::conflict);
  });
}

TEST(OctreeFile, ABinaryTreeShowsStockProgramsWhatIsOccupied) {
  const Snapshot map = worlds::random_map(9).snapshot();
  std::istringstream stream(format_binary_tree(map.tree()));
  octomap::OcTree tree(0.1);
  ::testing::internal::CaptureStderr();
  ASSERT_TRUE(tree.readBinary(stream));
  ::testing::internal::GetCapturedStderr();
  EXPECT_EQ(tree.getResolution(), map.resolution());
  map.visit_leaves([&](const Voxel& voxel) {
    const auto* node = tree.search(voxel.center.x(), voxel.center.y(), voxel.center.z());
    ASSERT_NE(node, nullptr);
    const bool blocked = voxel.state == VoxelState::occupied || voxel.state == VoxelState::conflict;
    ASSERT_EQ(tree.isNodeOccupied(node), blocked);
  });
}

TEST(OctreeFile, FilesForOtherProgramsKeepWhatTheMapSaysOfItself) {
  const Snapshot map = worlds::random_map(9).snapshot();
  FusedTree tree = map.tree();
  EXPECT_EQ(format_color_tree(tree).find("clearway"), std::string::npos) << "nothing to say";
  tree.set_records_before_damage(37);
  tree.add_hand_edits({.occupied = 3, .freed = 7296, .cut = 5});
  for (const std::string& bytes : {format_color_tree(tree), format_binary_tree(tree)}) {
    const OctreeContent read = parse_octree(bytes, "x.ot");
    EXPECT_EQ(read.tree->records_before_damage(), 37U);
    EXPECT_EQ(read.tree->hand_edits().occupied, 3U);
    EXPECT_EQ(read.tree->hand_edits().freed, 7296U);
    EXPECT_EQ(read.tree->hand_edits().cut, 5U);
    EXPECT_FALSE(read.has_volumes);
    std::string broken = bytes;
    broken.replace(broken.find("7296"), 4, "many");
    EXPECT_THROW(parse_octree(broken, "x.ot"), DamagedFile);
  }
  std::istringstream color(format_color_tree(tree)), binary(format_binary_tree(tree));
  const std::unique_ptr<octomap::AbstractOcTree> stock(octomap::AbstractOcTree::read(color));
  ASSERT_NE(stock, nullptr);
  EXPECT_EQ(stock->size(), map.tree().size());
  octomap::OcTree bits(0.1);
  ::testing::internal::CaptureStderr();
  EXPECT_TRUE(bits.readBinary(binary));
  ::testing::internal::GetCapturedStderr();
  EXPECT_GT(bits.size(), 100U);
}

}  // namespace octree_file_test
}  // namespace clearway
