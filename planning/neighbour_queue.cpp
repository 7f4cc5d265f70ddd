#include "planning/neighbour_queue.hpp"

#include <algorithm>
#include <array>
#include <stdexcept>
#include <utility>

namespace clearway {
namespace {

std::size_t rank_of(std::uint64_t ranks, std::size_t joint) { return ranks >> (2 * joint) & 3u; }

}  // namespace

void NeighbourQueue::add_head(int head, const LatticeIndex& node) {
  if (node.size() > 32) throw std::invalid_argument("beam: robots of more than 32 joints are not supported");
  Choices choices{head, node, {}, {}};
  for (std::size_t j = 0; j < node.size(); ++j) {
    std::array<std::pair<double, int>, 3> ranked;
    for (int change = -1; change <= 1; ++change) {
      ranked[static_cast<std::size_t>(change + 1)] = {
          lattice_->distance_term(static_cast<Eigen::Index>(j), node[j] + change), change};
    }
    std::sort(ranked.begin(), ranked.end());
    for (const auto& [term, change] : ranked) {
      choices.term.push_back(term);
      choices.change.push_back(change);
    }
  }
  heads_.push_back(std::move(choices));
  push(static_cast<std::uint32_t>(heads_.size() - 1), 0, 0);
}

void NeighbourQueue::push(std::uint32_t head, std::uint64_t ranks, int last) {
  const Choices& choices = heads_[head];
  double sum = 0.0;  // in joint order, as Lattice::squared_distance
  for (std::size_t j = 0; j < choices.node.size(); ++j) sum += choices.term[3 * j + rank_of(ranks, j)];
  heap_.push({sum, head, ranks, last});
}

Neighbour NeighbourQueue::pop() {
  const Entry top = heap_.top();
  heap_.pop();
  const std::size_t n = heads_[top.head].node.size();
  for (std::size_t j = static_cast<std::size_t>(top.last); j < n; ++j) {
    if (rank_of(top.ranks, j) < 2)
      push(top.head, top.ranks + (std::uint64_t{1} << (2 * j)), static_cast<int>(j));
  }
  const Choices& choices = heads_[top.head];
  Neighbour neighbour{top.squared_distance, choices.head, choices.node};
  for (std::size_t j = 0; j < n; ++j) neighbour.node[j] += choices.change[3 * j + rank_of(top.ranks, j)];
  return neighbour;
}

}  // namespace clearway
