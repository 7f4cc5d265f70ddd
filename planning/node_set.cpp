#include "planning/node_set.hpp"

#include <algorithm>
#include <stdexcept>

namespace clearway {

std::size_t NodeSet::slot_of(const LatticeIndex& node) const { return slot_of(node.data()); }

std::size_t NodeSet::slot_of(const int* node) const {
  std::uint64_t hash = 0;
  for (std::size_t j = 0; j < joints_; ++j) {
    hash = (hash ^ static_cast<std::uint32_t>(node[j])) * 0x9e3779b97f4a7c15U;
    hash ^= hash >> 29U;
  }
  const std::size_t mask = slots_.size() - 1;
  for (std::size_t slot = hash & mask;; slot = (slot + 1) & mask) {
    const std::uint32_t number = slots_[slot];
    if (number == none || std::equal(node, node + joints_, &indices_[number * joints_])) return slot;
  }
}

bool NodeSet::insert(const LatticeIndex& node) {
  std::size_t slot = slot_of(node);
  if (slots_[slot] != none) return false;
  if (size_ + 1 >= none) throw std::length_error("beam: too many nodes");
  if (3 * (size_ + 1) > 2 * slots_.size()) {
    slots_.assign(2 * slots_.size(), none);
    for (std::uint32_t number = 0; number < size_; ++number)
      slots_[slot_of(&indices_[number * joints_])] = number;
    slot = slot_of(node);
  }
  slots_[slot] = static_cast<std::uint32_t>(size_++);
  indices_.insert(indices_.end(), node.begin(), node.end());
  return true;
}

void NodeSet::clear() {
  std::fill(slots_.begin(), slots_.end(), none);
  indices_.clear();
  size_ = 0;
}

}  // namespace clearway
