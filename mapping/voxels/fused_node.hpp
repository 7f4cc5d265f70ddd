#pragma once

// Includes OctoMap; include it from .cpp files and fused_tree.hpp only.

#include <octomap/OcTreeNode.h>
#include <octomap/OccupancyOcTreeBase.h>

#include <atomic>
#include <cstdint>
#include <istream>
#include <ostream>

namespace clearway {

/// What sensors and painting know of one voxel, or of an inner cube: log-odds of the sensors (`value`),
/// whether any ray touched it, and the painted volumes that contain all of it. No larger than
/// octomap::OcTreeNode. OctoMap finds these functions by static type; each hides one of the stock node on
/// purpose.
///
/// Nodes may be shared by several trees (see FusedTree): `owners` counts the child arrays and roots that hold
/// one. A node reachable by two trees is never written.
class FusedNode : public octomap::OcTreeNode {
 public:
  /// Log-odds that an unobserved node carries: just under "occupied", so that stock code which knows no
  /// `observed` flag (castRay, .bt export) never takes a painted voxel for an obstacle. Observing starts at
  /// 0.
  static constexpr float unobserved_log_odds = -1e-6F;

  FusedNode() { value = unobserved_log_odds; }
  FusedNode(const FusedNode& other);  ///< of the same content, on shared children
  FusedNode& operator=(const FusedNode&) = delete;

  // 16 bytes from a pool, where malloc takes 32, and 64 for eight children, where it takes 80 (see
  // node_pool.hpp).
  static void* operator new(std::size_t size);
  static void operator delete(void* node, std::size_t size);

  bool operator==(const FusedNode& other) const {
    // Not with &&: g++ makes one load of two such comparisons, and with it reads `owners_`, which other
    // threads may be counting.
    return value == other.value && ((painted_ ^ other.painted_) | (observed_ ^ other.observed_)) == 0;
  }
  void copyData(const FusedNode& from);

  /// Inner node from its children: maximum log-odds of the observed ones, AND of all eight masks (a missing
  /// child is painted by no volume).
  void updateOccupancyChildren();

  std::istream& readData(std::istream& stream);
  std::ostream& writeData(std::ostream& stream) const;

  bool observed() const { return observed_ != 0; }
  std::uint16_t painted() const { return painted_; }

  void add_paint(std::uint16_t volumes) { painted_ = static_cast<std::uint16_t>(painted_ | volumes); }
  void remove_paint(std::uint16_t volumes) { painted_ = static_cast<std::uint16_t>(painted_ & ~volumes); }
  /// Back to what a new node knows: neither observed nor painted.
  void forget();
  /// Back to never observed; the paint stays.
  void unobserve() {
    value = unobserved_log_odds;
    observed_ = 0;
  }
  /// Marks as observed; the first time log-odds start from 0.
  void observe();
  void observe(float log_odds);

  /// True when one tree alone holds this node, if it alone holds the parent.
  bool has_one_owner() const { return owners().load(std::memory_order_acquire) == 1; }
  /// One more owner: this node, or a copy of it when no more owners can be counted.
  FusedNode* share();
  /// One owner less; the last one takes the node away, and its hold on the children.
  static void release(FusedNode* node);

  bool has_children() const { return children != nullptr; }
  const FusedNode* child(unsigned index) const { return static_cast<const FusedNode*>(children[index]); }
  FusedNode* child(unsigned index) { return static_cast<FusedNode*>(children[index]); }

  /// The child to descend into, held by one tree alone if this node is: created under a new or partly filled
  /// node, expanded from a pruned one, copied from a shared one. Counts new nodes into `nodes`.
  /// @param just_created this node. @param created whether the child was made without content.
  FusedNode& child_for_writing(unsigned index, bool just_created, bool& created, std::size_t& nodes) {
    FusedNode* const stored = children == nullptr ? nullptr : child(index);
    if (stored == nullptr || !stored->has_one_owner())
      return make_writable(index, just_created, created, nodes);
    created = false;
    return *stored;
  }
  /// Makes this node a leaf when its children are eight equal leaves. Counts them out of `nodes`.
  bool prune(std::size_t& nodes);
  /// Asks the cache for what a descent to the grandchildren reads.
  void prefetch_below() const;
  /// Eight places for children, all empty. Precondition: a leaf.
  void make_children();
  /// Lets go of all children and their places, if there are any.
  void drop_children();

 private:
  friend class FusedTree;
  FusedNode& add_child(unsigned index);
  FusedNode& make_writable(unsigned index, bool just_created, bool& created, std::size_t& nodes);
  std::atomic_ref<std::uint8_t> owners() const { return std::atomic_ref<std::uint8_t>(owners_); }

  std::uint16_t painted_ = 0;
  std::uint8_t observed_ = 0;
  mutable std::uint8_t owners_ = 1;
};
static_assert(sizeof(FusedNode) == sizeof(octomap::OcTreeNode));

}  // namespace clearway

// OctoMap's own functions that make and delete arrays of children, for nodes whose arrays lie in the pool.
namespace octomap {

template <>
void OcTreeBaseImpl<clearway::FusedNode, AbstractOccupancyOcTree>::allocNodeChildren(
    clearway::FusedNode* node);
template <>
void OcTreeBaseImpl<clearway::FusedNode, AbstractOccupancyOcTree>::deleteNodeRecurs(
    clearway::FusedNode* node);

}  // namespace octomap
