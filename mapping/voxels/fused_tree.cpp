#include "mapping/voxels/fused_tree.hpp"

#include <algorithm>
#include <mutex>

namespace clearway {

FusedTree::FusedTree(const FusedTree& other)
    : OccupancyOcTreeBase<FusedNode>(other.resolution), integration_(other.integration_) {
  clearKeyRays();  // 600 kB that only OctoMap's own insertion uses
  clamping_thres_min = other.clamping_thres_min;
  clamping_thres_max = other.clamping_thres_max;
  prob_hit_log = other.prob_hit_log;
  prob_miss_log = other.prob_miss_log;
  occ_prob_thres_log = other.occ_prob_thres_log;
  if (other.root != nullptr) root = other.root->share();
  tree_size = other.tree_size;
  records_before_damage_ = other.records_before_damage_;
  hand_edits_ = other.hand_edits_;
  agreement_ = other.agreement_;
  size_changed = true;
}

FusedTree::~FusedTree() { release_root(); }

void FusedTree::release_root() {
  FusedNode::release(root);
  root = nullptr;
  tree_size = 0;
  size_changed = true;
}

void FusedTree::register_type() {
  static std::once_flag once;
  std::call_once(once, [] {
    auto* prototype = new FusedTree(0.1);  // OctoMap's registry keeps it until the program ends
    prototype->clearKeyRays();
    octomap::AbstractOcTree::registerTreeType(prototype);
  });
}

void FusedTree::updateNodeLogOdds(FusedNode* node, const float& update) const {
  node->observe();
  OccupancyOcTreeBase<FusedNode>::updateNodeLogOdds(node, update);
}

VoxelState FusedTree::state(const FusedNode& node) const {
  const bool painted = node.painted() != 0;
  if (node.observed() && isNodeOccupied(node)) return painted ? VoxelState::conflict : VoxelState::occupied;
  if (painted) return VoxelState::painted;
  return node.observed() ? VoxelState::seen_free : VoxelState::unknown;
}

std::optional<Eigen::Vector3i> FusedTree::cell(const Eigen::Vector3d& point) const {
  Eigen::Vector3i result;
  for (int axis = 0; axis < 3; ++axis) {
    const double scaled = std::floor(resolution_factor * point[axis]);
    if (!(scaled >= -32768.0 && scaled <= 32767.0)) return std::nullopt;  // also refuses NaN
    result[axis] = static_cast<int>(scaled);
  }
  return result;
}

FusedNode& FusedTree::root_for_writing(bool& created) {
  created = root == nullptr;
  if (created) {
    root = new FusedNode();
    tree_size = 1;
    size_changed = true;
  } else if (!root->has_one_owner()) {
    auto* copy = new FusedNode(*root);
    FusedNode::release(root);
    root = copy;
  }
  return *root;
}

FusedNode& FusedTree::child_for_writing(FusedNode& node, unsigned index, bool just_created, bool& created) {
  size_changed = true;
  return node.child_for_writing(index, just_created, created, tree_size);
}

bool FusedTree::pruneNode(FusedNode* node) {
  const bool pruned = node->prune(tree_size);
  size_changed |= pruned;
  return pruned;
}

FusedNode* FusedTree::updateNode(const octomap::OcTreeKey& key, float update, bool lazy) {
  FusedNode* leaf = search(key);
  const bool clamped = leaf != nullptr && ((update >= 0.0F && leaf->getLogOdds() >= clamping_thres_max) ||
                                           (update <= 0.0F && leaf->getLogOdds() <= clamping_thres_min));
  if (clamped) return leaf;
  bool created = false;
  FusedNode& top = root_for_writing(created);
  return update_below(top, created, 0, key, update, lazy);
}

FusedNode* FusedTree::update_below(FusedNode& node, bool just_created, unsigned depth,
                                   const octomap::OcTreeKey& key, float update, bool lazy) {
  if (depth == tree_depth) {
    updateNodeLogOdds(&node, update);
    return &node;
  }
  const unsigned index = octomap::computeChildIdx(key, static_cast<int>(tree_depth - 1 - depth));
  bool created = false;
  FusedNode& child = child_for_writing(node, index, just_created, created);
  FusedNode* const updated = update_below(child, created, depth + 1, key, update, lazy);
  if (lazy) return updated;
  if (pruneNode(&node)) return &node;
  node.updateOccupancyChildren();
  return updated;
}

void FusedTree::set_observed(const octomap::OcTreeKey& key, float log_odds) {
  bool created = false;
  FusedNode* node = &root_for_writing(created);
  for (unsigned level = 0; level < tree_depth; ++level) {
    const unsigned index = octomap::computeChildIdx(key, static_cast<int>(tree_depth - 1 - level));
    bool child_created = false;
    node = &child_for_writing(*node, index, created, child_created);
    created = child_created;
  }
  node->observe(log_odds);
}

void FusedTree::set_leaf(const CellCube& cube, const FusedNode& content) {
  bool created = false;
  FusedNode* node = &root_for_writing(created);
  for (CellCube at; at.edge > cube.edge;) {
    const Eigen::Array3i upper = (cube.corner - at.corner).array() / (at.edge / 2);
    const auto index = static_cast<unsigned>(upper[0] + 2 * upper[1] + 4 * upper[2]);
    bool child_created = false;
    node = &child_for_writing(*node, index, created, child_created);
    created = child_created;
    at = at.child(index);
  }
  node->copyData(content);
}

void FusedTree::finish() {
  updateInnerOccupancy();
  prune();
}

const FusedNode* FusedTree::find_leaf(const Eigen::Vector3i& cell, CellCube& cube) const {
  const FusedNode* node = root;
  cube = CellCube{};
  while (node != nullptr && nodeHasChildren(node)) {
    const Eigen::Array3i upper = (cell - cube.corner).array() / (cube.edge / 2);
    const auto index = static_cast<unsigned>(upper[0] + 2 * upper[1] + 4 * upper[2]);
    node = nodeChildExists(node, index) ? getNodeChild(node, index) : nullptr;
    cube = cube.child(index);
  }
  return node;
}

}  // namespace clearway
