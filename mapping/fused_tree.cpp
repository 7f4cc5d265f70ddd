#include "mapping/fused_tree.hpp"

#include <algorithm>
#include <limits>
#include <mutex>

#include "mapping/node_pool.hpp"

namespace clearway {

FusedNode::FusedNode(const FusedNode& other) : octomap::OcTreeNode() {
  copyData(other);
  if (other.children == nullptr) return;
  children = new octomap::AbstractOcTreeNode*[8]();
  for (unsigned i = 0; i < 8; ++i) {
    if (other.children[i] != nullptr) children[i] = static_cast<FusedNode*>(other.children[i])->share();
  }
}

void* FusedNode::operator new(std::size_t size) { return NodePool::allocate(size); }
void FusedNode::operator delete(void* node, std::size_t size) { NodePool::free(node, size); }

FusedNode* FusedNode::share() {
  std::uint8_t count = owners().load(std::memory_order_relaxed);
  do {
    if (count == std::numeric_limits<std::uint8_t>::max()) return new FusedNode(*this);
  } while (!owners().compare_exchange_weak(count, static_cast<std::uint8_t>(count + 1),
                                           std::memory_order_relaxed));
  return this;
}

void FusedNode::release(FusedNode* node) {
  if (node == nullptr || node->owners().fetch_sub(1, std::memory_order_acq_rel) != 1) return;
  if (node->children != nullptr) {
    for (unsigned i = 0; i < 8; ++i) release(static_cast<FusedNode*>(node->children[i]));
    delete[] node->children;
    node->children = nullptr;
  }
  delete node;
}

void FusedNode::copyData(const FusedNode& from) {
  value = from.value;
  painted_ = from.painted_;
  observed_ = from.observed_;
}

void FusedNode::updateOccupancyChildren() {
  bool any_observed = false;
  float highest = std::numeric_limits<float>::lowest();
  std::uint16_t common = 0xffff;
  for (unsigned i = 0; i < 8; ++i) {
    const auto* child = children == nullptr ? nullptr : static_cast<const FusedNode*>(children[i]);
    common = static_cast<std::uint16_t>(common & (child == nullptr ? 0 : child->painted_));
    if (child == nullptr || !child->observed()) continue;
    any_observed = true;
    highest = std::max(highest, child->value);
  }
  painted_ = common;
  observed_ = any_observed ? 1 : 0;
  value = any_observed ? highest : unobserved_log_odds;
}

std::istream& FusedNode::readData(std::istream& stream) {
  stream.read(reinterpret_cast<char*>(&value), sizeof(value));
  stream.read(reinterpret_cast<char*>(&painted_), sizeof(painted_));
  return stream.read(reinterpret_cast<char*>(&observed_), sizeof(observed_));
}

std::ostream& FusedNode::writeData(std::ostream& stream) const {
  stream.write(reinterpret_cast<const char*>(&value), sizeof(value));
  stream.write(reinterpret_cast<const char*>(&painted_), sizeof(painted_));
  return stream.write(reinterpret_cast<const char*>(&observed_), sizeof(observed_));
}

void FusedNode::observe() {
  if (observed()) return;
  observed_ = 1;
  value = 0.0F;
}

void FusedNode::observe(float log_odds) {
  observed_ = 1;
  value = log_odds;
}

void FusedNode::forget() {
  value = unobserved_log_odds;
  painted_ = 0;
  observed_ = 0;
}

FusedTree::FusedTree(const FusedTree& other) : OccupancyOcTreeBase<FusedNode>(other.resolution) {
  clearKeyRays();  // 600 kB that only OctoMap's own insertion uses
  clamping_thres_min = other.clamping_thres_min;
  clamping_thres_max = other.clamping_thres_max;
  prob_hit_log = other.prob_hit_log;
  prob_miss_log = other.prob_miss_log;
  occ_prob_thres_log = other.occ_prob_thres_log;
  if (other.root != nullptr) root = other.root->share();
  tree_size = other.tree_size;
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
  created = false;
  if (!nodeChildExists(&node, index)) {
    if (node.children == nullptr && !just_created) {
      expandNode(&node);
    } else {
      createNodeChild(&node, index);
      created = true;
    }
    return *getNodeChild(&node, index);
  }
  FusedNode* child = getNodeChild(&node, index);
  if (child->has_one_owner()) return *child;
  node.children[index] = new FusedNode(*child);
  FusedNode::release(child);
  return *getNodeChild(&node, index);
}

bool FusedTree::pruneNode(FusedNode* node) {
  if (node->children == nullptr) return false;
  const FusedNode* first = node->child(0);
  for (unsigned i = 0; i < 8; ++i) {
    const FusedNode* child = node->child(i);
    if (child == nullptr || child->has_children() || !(*child == *first)) return false;
  }
  node->copyData(*first);
  for (unsigned i = 0; i < 8; ++i) FusedNode::release(static_cast<FusedNode*>(node->children[i]));
  delete[] node->children;
  node->children = nullptr;
  tree_size -= 8;
  size_changed = true;
  return true;
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
