#pragma once

#include "planning/beam/node_set.hpp"

namespace clearway {

/// The nodes that a beam need not look at: those visited before, and those known to be blocked. Of the latter
/// the first joints alone are kept where these alone place what is blocked; all nodes that begin so are
/// closed with it.
class BlockedNodes {
 public:
  /// @param visited outlives it; nodes of all joints.
  BlockedNodes(std::size_t joints, const NodeSet& visited);

  std::size_t joints() const { return blocked_.size() - 1; }
  /// All nodes with these first joints are blocked. What is known is bounded: beyond `most` it begins anew.
  void block(const int* node, std::size_t first_joints, std::size_t most);
  /// Whether the first joints of a node alone, all of them but no fewer, close it.
  bool is_closed(const int* node, std::size_t first_joints, std::uint64_t hash) const {
    const NodeSet& blocked = blocked_[first_joints];
    return (blocked.size() > 0 && blocked.find(node, hash) != NodeSet::none) ||
           (first_joints == joints() && visited_.find(node, hash) != NodeSet::none);
  }
  /// Whether any first joints of it, known not to have been visited, are blocked.
  bool is_blocked(const LatticeIndex& node) const;

 private:
  const NodeSet& visited_;
  std::vector<NodeSet> blocked_;  ///< by number of joints
  std::size_t size_ = 0;          ///< of all of them
};

}  // namespace clearway
