#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "planning/beam/beam_lattice.hpp"

namespace clearway {

/// A set of lattice nodes, hashed by their indices and numbered in the order in which they came: four bytes a
/// joint and 18 to 36 more a node.
class NodeSet {
 public:
  static constexpr std::uint32_t none = ~std::uint32_t{0};

  /// Of nodes with so many joints.
  explicit NodeSet(std::size_t joints) : joints_(joints), slots_(16), marks_(2) {}

  /// A node's hash is the sum of these over its joints, so that whoever steps from node to node adds.
  static std::uint64_t hash_term(std::size_t joint, int index) {
    return multipliers[joint % multipliers.size()] * static_cast<std::uint64_t>(index);
  }
  std::uint64_t hash(const int* node) const;
  /// Spreads such a sum, whose low bits are poor, over all bits: take the low ones.
  static std::size_t mixed(std::uint64_t hash) { return static_cast<std::size_t>(spread(hash) >> 32U); }

  /// The node's number, or none.
  std::uint32_t find(const int* node, std::uint64_t hash) const {
    return is_marked(hash) ? slots_[slot_of(node, hash)].number : none;
  }
  std::uint32_t find(const int* node) const { return find(node, hash(node)); }
  bool contains(const LatticeIndex& node) const { return find(node.data()) != none; }
  /// False when it was in the set already. A new one's number is the size before.
  bool insert(const int* node);
  bool insert(const LatticeIndex& node) { return insert(node.data()); }
  void clear();
  std::size_t size() const { return size_; }

 private:
  struct Slot {
    std::uint32_t tag = 0, number = none;
  };
  static constexpr std::array<std::uint64_t, 64> multipliers = [] {  // odd, and as good as drawn
    std::array<std::uint64_t, 64> drawn{};
    std::uint64_t state = 0;
    for (std::uint64_t& value : drawn) {
      state += 0x9e3779b97f4a7c15U;
      value = (state ^ state >> 30U) * 0xbf58476d1ce4e5b9U;
      value = (value ^ value >> 27U) * 0x94d049bb133111ebU;
      value = (value ^ value >> 31U) | 1U;
    }
    return drawn;
  }();

  static std::uint64_t spread(std::uint64_t hash) { return (hash ^ hash >> 32U) * 0x9e3779b97f4a7c15U; }
  /// Of a hash, in marks_.
  std::size_t mark_of(std::uint64_t hash) const { return mixed(hash) & (64 * marks_.size() - 1); }
  /// False when no node of the set has this hash: most questions end here, in a small part of the memory.
  bool is_marked(std::uint64_t hash) const {
    const std::size_t mark = mark_of(hash);
    return (marks_[mark / 64] >> (mark % 64) & 1U) != 0;
  }
  /// Where the node is, or would be put.
  std::size_t slot_of(const int* node, std::uint64_t hash) const;

  std::size_t joints_, size_ = 0;
  std::vector<int> indices_;          ///< node after node
  std::vector<Slot> slots_;           ///< a power of two of them, at least half empty
  std::vector<std::uint64_t> marks_;  ///< a bit for each hash, modulo their number: eight a slot
};

}  // namespace clearway
