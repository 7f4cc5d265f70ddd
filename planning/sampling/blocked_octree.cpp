#include "planning/sampling/blocked_octree.hpp"

#include <octomap/OcTree.h>

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

/// Gives `blocked` the leaves of what `listed` has, or of what it has not.
class BlockedLeaves {
 public:
  BlockedLeaves(const LeafTree& listed, bool listed_are_blocked, LeafTree& blocked)
      : listed_(listed), listed_are_blocked_(listed_are_blocked), blocked_(blocked) {}

  void run() { walk(listed_.getRoot(), Eigen::Vector3d::Zero(), 0); }

 private:
  /// `node`: null where nothing is listed; `center`: of its cube.
  void walk(const Node* node, const Eigen::Vector3d& center, unsigned depth) {
    if (node == nullptr || !listed_.nodeHasChildren(node)) {
      if ((node != nullptr) == listed_are_blocked_) blocked_.add_leaf(center, depth);
      return;
    }
    const double quarter = listed_.getNodeSize(depth) / 4;
    for (unsigned i = 0; i < 8; ++i) {
      const auto side = [&](unsigned bit) { return (i & bit) != 0 ? quarter : -quarter; };
      walk(listed_.nodeChildExists(node, i) ? listed_.getNodeChild(node, i) : nullptr,
           center + Eigen::Vector3d(side(1), side(2), side(4)), depth + 1);
    }
  }

  const LeafTree& listed_;
  bool listed_are_blocked_;
  LeafTree& blocked_;
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
  LeafTree listed(map.resolution());
  const auto add = [&](const Eigen::Vector3d& center, double size) {
    const auto levels = static_cast<unsigned>(std::lround(std::log2(size / map.resolution())));
    listed.add_leaf(center, listed.getTreeDepth() - levels);
  };
  map.visit_leaves([&](const Voxel& leaf) {
    if (allows(requirement, leaf.state, leaf.volumes) != unknown_is_blocked) return;
    if (requirement.seen_within == 0.0 || leaf.state != VoxelState::seen_free)
      return add(leaf.center, leaf.size);
    visit_seen_within(map, leaf, requirement.seen_within, add);
  });
  auto blocked = std::make_shared<LeafTree>(map.resolution());
  BlockedLeaves(listed, !unknown_is_blocked, *blocked).run();
  mark_occupied(*blocked);
  return blocked;
}

}  // namespace clearway
