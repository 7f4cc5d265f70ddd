// Octomaps and planes of scenes, against OctoMap's own library and against arithmetic.
#include "apps/problem_sets/scene_octomap.hpp"

#include <octomap/ColorOcTree.h>
#include <octomap/OcTree.h>

#include <random>
#include <set>
#include <sstream>

#include "mapping/voxels/fused_tree.hpp"
#include "tests/apps/problem_sets/import_fixture.hpp"

namespace clearway {
namespace import_test {

using Keys = std::set<std::array<int, 3>>;

/// As octomap_msgs/conversions.h writes a map: the tree's data without its header.
template <class Tree>
std::string message_of(const Tree& tree, bool is_binary, bool is_signed = true) {
  std::stringstream stream;
  if constexpr (std::is_same_v<Tree, octomap::OcTree>) {
    is_binary ? tree.writeBinaryData(stream) : tree.writeData(stream);
  } else {
    tree.writeData(stream);
  }
  std::string data;
  for (const char byte : stream.str())
    data += (data.empty() ? "" : ", ") +
            std::to_string(is_signed ? static_cast<signed char>(byte) : static_cast<unsigned char>(byte));
  return "octomap: {binary: " + std::string(is_binary ? "true" : "false") + ", id: " + tree.getTreeType() +
         ", resolution: " + std::to_string(tree.getResolution()) + ", data: [" + data + "]}";
}

/// 300 single voxels and two blocks of 8, which it prunes, of each half are occupied.
octomap::OcTree random_tree(Keys& occupied) {
  octomap::OcTree tree(0.1);
  std::mt19937 random(7);
  for (int i = 0; i < 300; ++i) {
    const std::array<int, 3> at{static_cast<int>(random() % 40) - 20, static_cast<int>(random() % 40) - 20,
                                static_cast<int>(random() % 40) - 20};
    const bool is_occupied = i % 2 == 0;
    tree.setNodeValue(octomap::point3d(0.1F * at[0] + 0.05F, 0.1F * at[1] + 0.05F, 0.1F * at[2] + 0.05F),
                      is_occupied ? 2.0F : -2.0F);
    is_occupied ? void(occupied.insert(at)) : void(occupied.erase(at));
  }
  for (int i = 0; i < 8; ++i)
    for (const int x : {24, -30}) {
      tree.setNodeValue(octomap::point3d(0.1F * (x + (i & 1)) + 0.05F, 0.1F * (i >> 1 & 1) + 0.05F,
                                         0.1F * (i >> 2) + 0.05F),
                        x > 0 ? 2.0F : -2.0F);
      if (x > 0) occupied.insert({x + (i & 1), i >> 1 & 1, i >> 2});
    }
  tree.toMaxLikelihood();
  tree.prune();
  return tree;
}

class ImportOctomap : public Import {
 protected:
  CommandRun import_world(const std::string& world, const Arguments& more = {}) {
    std::filesystem::remove_all(folder_ / "out");
    return import("mbm", {folder_.write("s.yaml", "world: {" + world + "}\n")}, more);
  }

  Keys occupied() const {
    Keys keys;
    const Snapshot world = map("s");
    for (auto leaf = world.tree().begin_leafs(), end = world.tree().end_leafs(); leaf != end; ++leaf) {
      const int edge = 1 << (16 - leaf.getDepth());
      const auto key = leaf.getIndexKey();
      for (int x = 0; x < edge; ++x)
        for (int y = 0; y < edge; ++y)
          for (int z = 0; z < edge; ++z)
            keys.insert({key[0] + x - 32768, key[1] + y - 32768, key[2] + z - 32768});
    }
    return keys;
  }
};

TEST_F(ImportOctomap, OfTheSameResolutionBecomesItsOccupiedVoxelsAndNoOthers) {
  Keys expected;
  const octomap::OcTree tree = random_tree(expected);
  octomap::ColorOcTree color(0.1);
  for (auto leaf = tree.begin_leafs(), end = tree.end_leafs(); leaf != end; ++leaf)
    color.setNodeValue(leaf.getKey(), leaf->getLogOdds());
  color.setNodeValue(octomap::point3d(2.45F, 0.05F, 0.05F), 2.0F);
  for (const std::string& message :
       {message_of(tree, true), message_of(tree, false), message_of(tree, true, false)}) {
    const CommandRun run = import_world("octomap: {header: {frame_id: base}, " + message + "}", {"--json"});
    ASSERT_EQ(run.status, exit_done) << run.log;
    EXPECT_EQ(Json::parse(run.out)["left_out"], Json::array());
    EXPECT_EQ(occupied(), expected);
    const Json objects = Json::parse(read_file(folder_.file("out/import.json")))["worlds"][0]["objects"];
    EXPECT_EQ(objects, (Json{{{"object", "<octomap>"}, {"kind", "octomap"}, {"voxels", expected.size()}}}));
  }
  EXPECT_EQ(import_world("octomap: {" + message_of(color, false) + "}").status, exit_done);
}

/// Half the edge: each voxel is eight. By the origin's pose and its frame's: a quarter turn about z, and 1 m.
TEST_F(ImportOctomap, StandsWhereItsOriginAndFrameAreAtAnyResolution) {
  Keys of_tree, expected, finer;
  const octomap::OcTree tree = random_tree(of_tree);
  for (const auto& [x, y, z] : of_tree) {
    expected.insert({-y - 1 + 10, x, z});  // [y, y + 1] becomes [-y - 1, -y]
    for (int i = 0; i < 8; ++i) finer.insert({2 * x + (i & 1), 2 * y + (i >> 1 & 1), 2 * z + (i >> 2)});
  }
  const CommandRun run = import_world(
      "octomap: {origin: {position: [1, 0, 0], orientation: [0, 0, 0.7071067811865476, "
      "0.7071067811865476]}, " +
      message_of(tree, true) + "}");
  ASSERT_EQ(run.status, exit_done) << run.log;
  EXPECT_EQ(occupied(), expected);
  resolution_ = "0.05";
  ASSERT_EQ(import_world("octomap: {" + message_of(tree, true) + "}").status, exit_done);
  EXPECT_EQ(occupied(), finer);
}

TEST_F(ImportOctomap, ThatIsNoTreeOrStandsInAnUnknownFrameIsRefused) {
  Keys keys;
  const std::string whole = message_of(random_tree(keys), true);
  const auto refused = [&](const std::string& world, const std::string& words) {
    const CommandRun run = import_world(world);
    EXPECT_EQ(run.status, exit_bad_input) << words;
    EXPECT_TRUE(run.complains_in_one_sentence()) << run.log;
    EXPECT_NE(run.log.find(words), std::string::npos) << run.log;
    EXPECT_FALSE(std::filesystem::exists(folder_ / "out"));
  };
  const auto of = [](const std::string& fields) { return "octomap: {octomap: {" + fields + "}}"; };
  const std::string head = "binary: true, id: OcTree, resolution: 0.1, data: ";
  refused("octomap: {header: {frame_id: kinect}, " + whole + "}",
          "its octomap in frame 'kinect', which is unknown");
  refused(of(head + "[3]"), "data: expected the bytes of a tree of OctoMap");
  refused(of(head + "[0, 0]"), "no children");
  refused(of(head + "[3, 0, 3, 0]"), "cut off");
  refused(of(head + "[1, 0, 3, 0]"), "it holds 2 nodes where its header says 3");
  refused(of(head + "[1, 0.5]"), "expected whole numbers");
  refused(of(head + "[256]"), "expected a number from -128 to 255");
  refused(of("binary: false, id: OcTree, resolution: 0.1, data: [1, 2]"), "tree of OctoMap");
  refused(of("binary: false, id: PointMap, resolution: 0.1, data: [0, 0, 0, 0, 0]"), "PointMap");
  refused(of("binary: true, id: OcTree, resolution: 0, data: [1, 0]"), "resolution");
  EXPECT_EQ(import_world(of(head + "[]")).status, exit_done);
}

/// The floor lies below z = 0, or above where its normal points down; a wall at x = 0.35 is the voxels that
/// it cuts.
TEST_F(ImportOctomap, PlanesAreSquaresOnTheirBlockedSide) {
  const auto plane = [](const std::string& numbers) {
    return "collision_objects: [{id: wall, planes: [{coef: [" + numbers + "]}]}]";
  };
  const auto expect_layer = [&](const std::string& world, int axis, int layer) {
    const CommandRun run = import_world(world, {"--json"});
    ASSERT_EQ(run.status, exit_done) << run.log;
    EXPECT_EQ(Json::parse(run.out)["left_out"], Json::array());
    std::size_t near = 0;
    for (const auto& key : occupied()) {
      EXPECT_EQ(key[static_cast<std::size_t>(axis)], layer) << world;
      bool is_near = true;
      for (int other = 0; other < 3; ++other)
        is_near = is_near && (other == axis || (key[static_cast<std::size_t>(other)] >= -30 &&
                                                key[static_cast<std::size_t>(other)] < 30));
      near += is_near;
    }
    EXPECT_EQ(near, 60U * 60U) << world;  // 3 m to each side, without a gap
  };
  expect_layer(plane("0, 0, 1, 0"), 2, -1);
  expect_layer(plane("0, 0, -2, 0"), 2, 0);
  expect_layer(plane("2, 0, 0, -0.7"), 0, 3);
  expect_layer(
      "collision_objects: [{id: wall, pose: {position: [0, 0, 0.55]}, planes: [{coef: [0, 0, 1, 0]}], "
      "plane_poses: [{position: [5, 0, 1]}]}]",
      2, 15);
  EXPECT_NE(import_world(plane("0, 0, 0, 1")).log.find("expected a b c d with a normal"), std::string::npos);
  std::filesystem::remove_all(folder_ / "out");
  const std::string text =
      folder_.write("s.scene", "(noname)\n* floor\n1\nplane\n0 0 1 0\n0 0 0\n0 0 0 1\n0 0 0 0\n.\n");
  ASSERT_EQ(import("scene", {text}).status, exit_done);
  const Keys keys = occupied();
  EXPECT_GE(keys.size(), 3600U);
  for (const auto& key : keys) EXPECT_EQ(key[2], -1);
}

}  // namespace import_test
}  // namespace clearway
