#include "planning/neighbour_queue.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <stdexcept>
#include <utility>

namespace clearway {
namespace {

constexpr double rounding = 1e-12;  ///< of sums of terms in another order, relative

std::size_t rank_of(std::uint64_t ranks, std::size_t joint) { return ranks >> (2 * joint) & 3u; }

}  // namespace

void NeighbourQueue::add_head(int head, const LatticeIndex& node) {
  const std::size_t n = node.size();
  if (n > 32) throw std::invalid_argument("beam: robots of more than 32 joints are not supported");
  Choices choices{head, node, {}, {}, std::vector<double>(n + 1), std::vector<double>(n + 1)};
  for (std::size_t j = 0; j < n; ++j) {
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
  double least = 0.0, most = 0.0;  // in joint order, as Lattice::squared_distance
  for (std::size_t j = 0; j < n; ++j) least += choices.term[3 * j], most += choices.term[3 * j + 2];
  for (std::size_t j = n; j-- > 0;) {
    choices.least_rest[j] = choices.least_rest[j + 1] + choices.term[3 * j];
    choices.most_rest[j] = choices.most_rest[j + 1] + choices.term[3 * j + 2];
  }
  least_ = heads_.empty() ? least : std::min(least_, least);
  most_ = std::max(most_, most);
  heads_.push_back(std::move(choices));
  most_entries_ = std::max<std::size_t>(4096, 64 * heads_.size());
}

/// The next band: until it holds some four times as many neighbours, by the volume of a ball in n dimensions.
void NeighbourQueue::widen() {
  const Choices& first = heads_.front();
  const double n = static_cast<double>(std::max<std::size_t>(first.node.size(), 1));
  begin_ = end_;
  if (band_ <= 0.0)
    band_ = (first.most_rest[0] - first.least_rest[0]) / (4.0 * n);
  else if (begin_ >= 0.0)
    band_ *= std::exp2(2.0 / n);
  end_ = least_ + band_;
  if (!(end_ > begin_)) end_ = most_;  // no such small difference in floating point
}

void NeighbourQueue::fill() {
  while (heap_.empty() && !heads_.empty() && end_ < most_) {
    widen();
    while (!enumerate_band()) {  // too many: a narrower band, as long as there is one
      const double low = std::max(begin_, least_), narrower = low + (end_ - low) / 4.0;
      most_entries_ =
          narrower > low && narrower < end_ ? most_entries_ : std::numeric_limits<std::size_t>::max();
      if (narrower > low) end_ = std::min(end_, narrower);
      band_ = end_ - least_;
    }
    std::make_heap(heap_.begin(), heap_.end());
  }
}

/// False when the band holds so many that memory would not be O(k) any more.
bool NeighbourQueue::enumerate_band() {
  heap_.clear();
  for (std::uint32_t head = 0; head < heads_.size(); ++head) {
    enumerate(head, 0, 0.0, 0);
    if (heap_.size() > most_entries_) return false;
  }
  return true;
}

void NeighbourQueue::enumerate(std::uint32_t head, std::size_t joint, double sum, std::uint64_t ranks) {
  const Choices& choices = heads_[head];
  if (joint == choices.node.size()) {
    if (sum > begin_ && sum <= end_) heap_.push_back({sum, head, ranks});
    return;
  }
  for (std::uint64_t rank = 0; rank < 3 && heap_.size() <= most_entries_; ++rank) {
    const double next = sum + choices.term[3 * joint + rank];
    if (next + choices.least_rest[joint + 1] > end_ * (1.0 + rounding)) return;
    if (next + choices.most_rest[joint + 1] < begin_ * (1.0 - rounding)) continue;
    enumerate(head, joint + 1, next, ranks | rank << (2 * joint));
  }
}

bool NeighbourQueue::empty() {
  if (heap_.empty()) fill();
  return heap_.empty();
}

double NeighbourQueue::next_squared_distance() {
  return empty() ? std::numeric_limits<double>::infinity() : heap_.front().squared_distance;
}

void NeighbourQueue::pop(Neighbour& neighbour) {
  if (empty()) throw std::logic_error("beam: no neighbour is left");
  std::pop_heap(heap_.begin(), heap_.end());
  const Entry top = heap_.back();
  heap_.pop_back();
  const Choices& choices = heads_[top.head];
  popped_ = top.squared_distance;
  neighbour.squared_distance = top.squared_distance;
  neighbour.head = choices.head;
  neighbour.node = choices.node;
  for (std::size_t j = 0; j < neighbour.node.size(); ++j)
    neighbour.node[j] += choices.change[3 * j + rank_of(top.ranks, j)];
}

Neighbour NeighbourQueue::pop() {
  Neighbour neighbour;
  pop(neighbour);
  return neighbour;
}

}  // namespace clearway
