#include "mapping/fused_tree.hpp"

#include <algorithm>
#include <limits>
#include <mutex>

namespace clearway {

FusedNode::FusedNode(const FusedNode& other) : octomap::OcTreeNode() {
  copyData(other);
  if (other.children == nullptr) return;
  children = new octomap::AbstractOcTreeNode*[8]();
  for (unsigned i = 0; i < 8; ++i) {
    if (other.children[i] == nullptr) continue;
    children[i] = new FusedNode(*static_cast<const FusedNode*>(other.children[i]));
  }
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

CellCube CellCube::child(unsigned index) const {
  const int half = edge / 2;
  const Eigen::Vector3i step(index & 1U ? half : 0, index & 2U ? half : 0, index & 4U ? half : 0);
  return {corner + step, half};
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

/// The child to descend into: created under a new or partly filled node, expanded from a pruned one.
FusedNode& FusedTree::child_for_writing(FusedNode& node, unsigned index, bool just_created, bool& created) {
  created = false;
  if (!nodeChildExists(&node, index)) {
    if (!nodeHasChildren(&node) && !just_created) {
      expandNode(&node);
    } else {
      createNodeChild(&node, index);
      created = true;
    }
  }
  return *getNodeChild(&node, index);
}

void FusedTree::set_observed(const octomap::OcTreeKey& key, float log_odds) {
  bool created = root == nullptr;
  if (created) {
    root = new FusedNode();
    tree_size = 1;
    size_changed = true;
  }
  FusedNode* node = root;
  for (unsigned level = 0; level < tree_depth; ++level) {
    const unsigned index = octomap::computeChildIdx(key, static_cast<int>(tree_depth - 1 - level));
    bool child_created = false;
    node = &child_for_writing(*node, index, created, child_created);
    created = child_created;
  }
  node->observe(log_odds);
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

namespace {

using LeafVisit = std::function<void(const FusedNode&, const CellCube&)>;

void visit_below(const FusedTree& tree, const FusedNode& node, const CellCube& cube,
                 const Eigen::Vector3i& first, const Eigen::Vector3i& last, const LeafVisit& visit) {
  if ((cube.corner.array() > last.array()).any()) return;
  if ((cube.corner.array() + (cube.edge - 1) < first.array()).any()) return;
  if (!tree.nodeHasChildren(&node)) return visit(node, cube);
  for (unsigned i = 0; i < 8; ++i) {
    if (!tree.nodeChildExists(&node, i)) continue;
    visit_below(tree, *tree.getNodeChild(&node, i), cube.child(i), first, last, visit);
  }
}

}  // namespace

void FusedTree::visit_leaves(const LeafVisit& visit) const {
  visit_leaves(Eigen::Vector3i::Constant(-32768), Eigen::Vector3i::Constant(32767), visit);
}

void FusedTree::visit_leaves(const Eigen::Vector3i& first, const Eigen::Vector3i& last,
                             const LeafVisit& visit) const {
  if (root != nullptr) visit_below(*this, *root, CellCube{}, first, last, visit);
}

}  // namespace clearway
