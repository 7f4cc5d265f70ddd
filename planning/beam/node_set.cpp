#include "planning/beam/node_set.hpp"

#include <algorithm>
#include <stdexcept>

namespace clearway {

std::uint64_t NodeSet::hash(const int* node) const {
  std::uint64_t sum = 0;
  for (std::size_t j = 0; j < joints_; ++j) sum += hash_term(j, node[j]);
  return sum;
}

std::size_t NodeSet::slot_of(const int* node, std::uint64_t hash) const {
  hash = spread(hash);
  const std::size_t mask = slots_.size() - 1;
  const auto tag = static_cast<std::uint32_t>(hash);
  for (std::size_t slot = hash >> 32U & mask;; slot = (slot + 1) & mask) {
    const Slot& at = slots_[slot];
    if (at.number == none) return slot;
    if (at.tag == tag && std::equal(node, node + joints_, indices_.data() + at.number * joints_)) return slot;
  }
}

bool NodeSet::insert(const int* node) {
  const std::uint64_t sum = hash(node);
  std::size_t slot = slot_of(node, sum);
  if (slots_[slot].number != none) return false;
  if (size_ + 1 >= none) throw std::length_error("beam: too many nodes");
  const auto put = [this](std::size_t place, std::uint64_t of, std::size_t number) {
    slots_[place] = {static_cast<std::uint32_t>(spread(of)), static_cast<std::uint32_t>(number)};
    const std::size_t mark = mark_of(of);
    marks_[mark / 64] |= std::uint64_t{1} << (mark % 64);
  };
  if (2 * (size_ + 1) > slots_.size()) {
    slots_.assign(2 * slots_.size(), {});
    marks_.assign(2 * marks_.size(), 0);
    for (std::size_t number = 0; number < size_; ++number) {
      const int* known = indices_.data() + number * joints_;
      const std::uint64_t of = hash(known);
      put(slot_of(known, of), of, number);
    }
    slot = slot_of(node, sum);
  }
  put(slot, sum, size_++);
  indices_.insert(indices_.end(), node, node + joints_);
  return true;
}

void NodeSet::clear() {
  std::fill(slots_.begin(), slots_.end(), Slot{});
  std::fill(marks_.begin(), marks_.end(), 0U);
  indices_.clear();
  size_ = 0;
}

}  // namespace clearway
