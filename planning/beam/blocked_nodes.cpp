#include "planning/beam/blocked_nodes.hpp"

namespace clearway {

BlockedNodes::BlockedNodes(std::size_t joints, const NodeSet& visited) : visited_(visited) {
  for (std::size_t first = 0; first <= joints; ++first) blocked_.emplace_back(first);
}

void BlockedNodes::block(const int* node, std::size_t first_joints, std::size_t most) {
  if (size_ >= most) {
    for (NodeSet& blocked : blocked_) blocked.clear();
    size_ = 0;
  }
  if (blocked_[first_joints].insert(node)) ++size_;
}

bool BlockedNodes::is_blocked(const LatticeIndex& node) const {
  std::uint64_t hash = 0;
  for (std::size_t first = 0; first <= joints(); ++first) {
    if (blocked_[first].size() > 0 && blocked_[first].find(node.data(), hash) != NodeSet::none) return true;
    if (first < joints()) hash += NodeSet::hash_term(first, node[first]);
  }
  return false;
}

}  // namespace clearway
