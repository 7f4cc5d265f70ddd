#include "planning/sampling/blocked_octree.hpp"

#include <octomap/OcTree.h>

#include <array>
#include <cmath>

#include "mapping/stamps/seen_stamps.hpp"
#include "mapping/voxels/fused_tree.hpp"

namespace clearway {
namespace {

using Node = octomap::OcTreeNode;

/// A tree of which the nodes are made one by one, each leaf as coarse as it comes.
class LeafTree : public octomap::OcTree {
 public:
  using octomap::OcTree::OcTree;

  Node* make_root() {
    if (root == nullptr) {
      root = new Node();
      ++tree_size;
    }
    return root;
  }

  /// The leaf of edge `resolution * 2^(16 - depth)` that holds `point`.
  void add_leaf(const Eigen::Vector3d& point, unsigned depth) {
    const octomap::OcTreeKey key = coordToKey(point.x(), point.y(), point.z());
    Node* node = make_root();
    for (unsigned level = 0; level < depth; ++level) {
      const unsigned child = octomap::computeChildIdx(key, static_cast<int>(tree_depth - 1 - level));
      node = nodeChildExists(node, child) ? getNodeChild(node, child) : createNodeChild(node, child);
    }
  }
};

/// Gives `blocked` leaves where `listed` has none, as coarse as may be.
class UnlistedLeaves {
 public:
  UnlistedLeaves(const LeafTree& listed, LeafTree& blocked) : listed_(listed), blocked_(blocked) {}

  void run() { walk(listed_.getRoot(), 0); }

 private:
  /// `node`: null where nothing is listed.
  void walk(const Node* node, unsigned depth) {
    if (node == nullptr) return add_leaf(depth);
    if (!listed_.nodeHasChildren(node)) return;
    for (unsigned i = 0; i < 8; ++i) {
      child_[depth] = i;
      made_[depth + 1] = nullptr;
      walk(listed_.nodeChildExists(node, i) ? listed_.getNodeChild(node, i) : nullptr, depth + 1);
    }
  }

  /// Where the walk is; made from the last node on the way that is there.
  void add_leaf(unsigned depth) {
    made_[0] = blocked_.make_root();
    for (unsigned level = 0; level < depth; ++level)
      if (made_[level + 1] == nullptr)
        made_[level + 1] = blocked_.createNodeChild(made_[level], child_[level]);
  }

  static constexpr std::size_t levels = 17;  // of every tree of OctoMap, the root's included
  const LeafTree& listed_;
  LeafTree& blocked_;
  std::array<unsigned, levels> child_{};
  std::array<Node*, levels> made_{};
};

/// Calls `visit(centre, edge)` for the cubes of a leaf that were seen lately enough.
template <class Visit>
void visit_seen_within(const Snapshot& map, const Voxel& leaf, double seconds, const Visit& visit) {
  const Eigen::Vector3d corner = (leaf.center.array() - leaf.size / 2) / map.resolution();
  const Eigen::Vector3i first = corner.array().round().cast<int>();
  const Eigen::Vector3i last =
      first.array() + static_cast<int>(std::lround(leaf.size / map.resolution())) - 1;
  map.seen()->visit_since(map.seen()->newest() - seconds, first, last, [&](const CellCube& cube) {
    visit((cube.corner.cast<double>().array() + 0.5 * cube.edge) * map.resolution(),
          cube.edge * map.resolution());
  });
}

/// Every leaf occupied, every inner node as well.
void mark_occupied(octomap::OcTree& tree) {
  for (auto leaf = tree.begin_leafs(), end = tree.end_leafs(); leaf != end; ++leaf) {
    leaf->setLogOdds(tree.getClampingThresMaxLog());
  }
  tree.updateInnerOccupancy();
}

}  // namespace

std::shared_ptr<octomap::OcTree> blocked_octree(const Snapshot& map, const Requirement& requirement) {
  const bool unknown_is_blocked = !allows(requirement, VoxelState::unknown, 0);
  auto listed = std::make_shared<LeafTree>(map.resolution());
  const auto add = [&](const Eigen::Vector3d& center, double size) {
    const auto levels = static_cast<unsigned>(std::lround(std::log2(size / map.resolution())));
    listed->add_leaf(center, listed->getTreeDepth() - levels);
  };
  map.visit_leaves([&](const Voxel& leaf) {
    if (allows(requirement, leaf.state, leaf.volumes) != unknown_is_blocked) return;
    if (requirement.seen_within == 0.0 || leaf.state != VoxelState::seen_free)
      return add(leaf.center, leaf.size);
    visit_seen_within(map, leaf, requirement.seen_within, add);
  });
  std::shared_ptr<LeafTree> blocked = listed;
  if (unknown_is_blocked) {
    blocked = std::make_shared<LeafTree>(map.resolution());
    UnlistedLeaves(*listed, *blocked).run();
  }
  mark_occupied(*blocked);
  return blocked;
}

}  // namespace clearway
