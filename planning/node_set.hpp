#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "planning/beam_lattice.hpp"

namespace clearway {

/// A set of lattice nodes, hashed by their indices: four bytes a joint and some eight more a node.
class NodeSet {
 public:
  /// Of nodes with so many joints.
  explicit NodeSet(std::size_t joints) : joints_(joints), slots_(16, none) {}

  bool contains(const LatticeIndex& node) const { return slots_[slot_of(node)] != none; }
  /// False when it was in the set already.
  bool insert(const LatticeIndex& node);
  void clear();
  std::size_t size() const { return size_; }

 private:
  static constexpr std::uint32_t none = ~std::uint32_t{0};

  /// Where the node is, or would be put.
  std::size_t slot_of(const LatticeIndex& node) const;
  std::size_t slot_of(const int* node) const;

  std::size_t joints_, size_ = 0;
  std::vector<int> indices_;  ///< node after node
  std::vector<std::uint32_t>
      slots_;  ///< a power of two of them, at least a third empty: a node's number, or none
};

}  // namespace clearway
