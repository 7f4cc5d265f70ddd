#include "planning/beam/frontier_batch.hpp"

#include <algorithm>
#include <limits>
#include <span>
#include <tuple>

#include "planning/beam/node_set.hpp"

namespace clearway {

void FrontierBatch::clear() {
  size_ = 0;
  for (std::vector<Choice>& choices : choices_) choices.clear();
  for (Bounds& bounds : bounds_) bounds.least.clear(), bounds.most.clear();
}

void FrontierBatch::add(const LatticeIndex& node, const Lattice& lattice) {
  const std::size_t joints = node.size();
  const std::uint64_t bit = std::uint64_t{1} << size_++;
  choices_.resize(joints);
  bounds_.resize(joints + 1);
  terms_.resize(joints);
  double nearest = 0.0, farthest = 0.0;
  for (std::size_t j = 0; j < joints; ++j) {
    std::vector<Choice>& choices = choices_[j];
    terms_[j] = {std::numeric_limits<double>::infinity(), 0.0};
    for (int index = node[j] - 1; index <= node[j] + 1; ++index) {
      auto place = std::find_if(choices.begin(), choices.end(),
                                [index](const Choice& choice) { return choice.index == index; });
      if (place == choices.end()) {
        const double term = lattice.distance_term(static_cast<Eigen::Index>(j), index);
        place = choices.insert(place, {term, NodeSet::hash_term(j, index), 0, index});
      }
      place->heads |= bit;
      terms_[j] = {std::min(terms_[j].first, place->term), std::max(terms_[j].second, place->term)};
    }
    nearest += terms_[j].first;
    farthest += terms_[j].second;
  }
  nearest_ = size_ == 1 ? nearest : std::min(nearest_, nearest);
  farthest_ = size_ == 1 ? farthest : std::max(farthest_, farthest);
  double least_rest = 0.0, most_rest = 0.0;
  for (std::size_t j = joints; j > 0; --j) {
    bounds_[j].least.push_back({least_rest, bit});
    bounds_[j].most.push_back({most_rest, bit});
    least_rest += terms_[j - 1].first;
    most_rest += terms_[j - 1].second;
  }
}

void FrontierBatch::finish() {
  for (std::vector<Choice>& choices : choices_) {
    std::sort(choices.begin(), choices.end(), [](const Choice& a, const Choice& b) {
      return std::tie(a.term, a.index) < std::tie(b.term, b.index);
    });
  }
  // Heads with the same sum share a bound, and each bound has the heads of those before it.
  const auto joined = [](std::vector<Bound>& bounds) {
    std::size_t used = 0;
    for (std::size_t i = 1; i < bounds.size(); ++i) {
      const Bound next = bounds[i];
      if (next.sum != bounds[used].sum) bounds[used + 1] = {next.sum, bounds[used].heads}, ++used;
      bounds[used].heads |= next.heads;
    }
    bounds.resize(used + 1);
  };
  for (Bounds& bounds : std::span(bounds_).subspan(1)) {
    std::sort(bounds.least.begin(), bounds.least.end(),
              [](const Bound& a, const Bound& b) { return a.sum < b.sum; });
    std::sort(bounds.most.begin(), bounds.most.end(),
              [](const Bound& a, const Bound& b) { return a.sum > b.sum; });
    joined(bounds.least);
    joined(bounds.most);
  }
}

std::uint64_t FrontierBatch::that_can_add_at_most(double sum, std::size_t joint) const {
  std::uint64_t heads = 0;
  for (const Bound& bound : bounds_[joint].least) {
    if (bound.sum > sum) break;
    heads = bound.heads;
  }
  return heads;
}

std::uint64_t FrontierBatch::that_can_add_at_least(double sum, std::size_t joint) const {
  std::uint64_t heads = 0;
  for (const Bound& bound : bounds_[joint].most) {
    if (bound.sum < sum) break;
    heads = bound.heads;
  }
  return heads;
}

}  // namespace clearway
