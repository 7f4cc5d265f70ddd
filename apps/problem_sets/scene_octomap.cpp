#include "apps/problem_sets/scene_octomap.hpp"

#include <cmath>
#include <string>

#include "apps/problem_sets/scene_fields.hpp"
#include "datasets/yaml/message_keys.hpp"
#include "mapping/files/map_leaves.hpp"
#include "mapping/files/octree_check.hpp"
#include "mapping/files/octree_file.hpp"
#include "mapping/system/damaged_file.hpp"

namespace clearway {
namespace {

std::string bytes_of(const YamlFields& octomap) {
  std::string bytes;
  for (const double value : octomap.numbers("data", {-128.0, 255.0})) {
    if (value != std::floor(value)) octomap.fail("data", "expected whole numbers");
    bytes += static_cast<char>(static_cast<unsigned char>(static_cast<int>(value) & 255));
  }
  return bytes;
}

/// How many nodes the bytes are of, which a message does not say: in a binary tree each child has two bits
/// that are not 0, in another each node has its log-odds, colours and mask of children.
std::size_t nodes_in(const std::string& bytes, bool is_binary, const std::string& type) {
  if (!is_binary) return bytes.size() / (type == "ColorOcTree" ? 8 : 5);
  std::size_t nodes = 1;
  for (const char byte : bytes)
    for (int bit = 0; bit < 8; bit += 2) nodes += ((static_cast<unsigned char>(byte) >> bit) & 3) != 0;
  return nodes;
}

}  // namespace

std::optional<ForeignSolid> read_octomap(const YamlFields& octomap,
                                         const Eigen::Isometry3d& map_from_octomap) {
  require_no_lost_keys(octomap, RosMessage::octomap);
  if (!octomap.has("data")) return std::nullopt;
  const std::string bytes = bytes_of(octomap);
  if (bytes.empty()) return std::nullopt;
  const bool is_binary = ros_truth(ros_word(octomap, "binary"));
  const std::string type = octomap.text("id");
  const double resolution = octomap.number("resolution", {1e-4, 100.0});
  ForeignSolid solid{"<octomap>", "octomap"};
  solid.map_from_shape = map_from_octomap;
  try {
    const OctreeContent content = parse_octree(
        octree_header(is_binary, type, nodes_in(bytes, is_binary, type), resolution) + bytes, "octomap");
    MapLeaves(Snapshot(content.tree, {})).visit([&](const MapLeaf& leaf) {
      const double edge = leaf.edge * resolution;
      if (leaf.state == VoxelState::occupied)
        solid.cubes.push_back(
            {resolution * leaf.corner.cast<double>() + Eigen::Vector3d::Constant(0.5 * edge), edge});
    });
  } catch (const DamagedFile& error) {
    octomap.fail("data", std::string("expected the bytes of a tree of OctoMap, but ") + error.what());
  }
  return solid;
}

}  // namespace clearway
