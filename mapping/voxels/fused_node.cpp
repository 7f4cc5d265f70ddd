#include "mapping/voxels/fused_node.hpp"

#include <algorithm>
#include <limits>

#include "mapping/voxels/node_pool.hpp"

namespace clearway {

FusedNode::FusedNode(const FusedNode& other) : octomap::OcTreeNode() {
  copyData(other);
  if (other.children == nullptr) return;
  make_children();
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
  node->drop_children();
  delete node;
}

void FusedNode::make_children() {
  static_assert(8 * sizeof(octomap::AbstractOcTreeNode*) == NodePool::children_bytes);
  children = new (NodePool::allocate(NodePool::children_bytes)) octomap::AbstractOcTreeNode* [8] {};
}

void FusedNode::drop_children() {
  if (children == nullptr) return;
  for (unsigned i = 0; i < 8; ++i) release(static_cast<FusedNode*>(children[i]));
  NodePool::free(children, NodePool::children_bytes);
  children = nullptr;
}

FusedNode& FusedNode::add_child(unsigned index) {
  auto* const made = new FusedNode();
  children[index] = made;
  return *made;
}

FusedNode& FusedNode::make_writable(unsigned index, bool just_created, bool& created, std::size_t& nodes) {
  created = false;
  if (children == nullptr) {
    make_children();
    if (!just_created) {
      for (unsigned i = 0; i < 8; ++i) add_child(i).copyData(*this);
      nodes += 8;
      return *static_cast<FusedNode*>(children[index]);
    }
  }
  auto* const child = static_cast<FusedNode*>(children[index]);
  if (child == nullptr) {
    created = true;
    ++nodes;
    return add_child(index);
  }
  if (child->has_one_owner()) return *child;
  auto* const copy = new FusedNode(*child);
  children[index] = copy;
  release(child);
  return *copy;
}

void FusedNode::prefetch_below() const {
  if (children == nullptr) return;
  for (unsigned i = 0; i < 8; ++i)
    if (child(i) != nullptr) __builtin_prefetch(child(i)->children);  // none: no harm
  for (unsigned i = 0; i < 8; ++i) {
    if (child(i) == nullptr || !child(i)->has_children()) continue;
    for (unsigned j = 0; j < 8; ++j) __builtin_prefetch(child(i)->child(j), 1);
  }
}

bool FusedNode::prune(std::size_t& nodes) {
  if (children == nullptr) return false;
  const FusedNode* const first = child(0);
  for (unsigned i = 0; i < 8; ++i) {
    const FusedNode* const each = child(i);
    if (each == nullptr || each->has_children() || !(*each == *first)) return false;
  }
  copyData(*first);
  drop_children();
  nodes -= 8;
  return true;
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

}  // namespace clearway

namespace octomap {

template <>
void OcTreeBaseImpl<clearway::FusedNode, AbstractOccupancyOcTree>::allocNodeChildren(
    clearway::FusedNode* node) {
  node->make_children();
}

template <>
void OcTreeBaseImpl<clearway::FusedNode, AbstractOccupancyOcTree>::deleteNodeRecurs(
    clearway::FusedNode* node) {
  clearway::FusedNode::release(node);
}

}  // namespace octomap
