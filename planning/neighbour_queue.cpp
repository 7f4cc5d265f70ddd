#include "planning/neighbour_queue.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <stdexcept>
#include <tuple>

namespace clearway {
namespace {

constexpr double rounding = 1e-12;  ///< of sums of terms in another order, relative

}  // namespace

void NeighbourQueue::restart(double band) {
  head_count_ = 0;
  entries_.clear();
  ways_.clear();
  next_ = 0;
  popped_ = 0;
  least_ = most_ = last_ = 0.0;
  band_ = band;
  begin_ = end_ = -1.0;
  widened_ = 0;
}

void NeighbourQueue::add_head(int number, const LatticeIndex& node) {
  joints_ = node.size();
  node_.resize(joints_);
  if (head_count_ == heads_.size()) heads_.emplace_back();
  Head& head = heads_[head_count_++];
  head.number = number;
  head.choices.resize(joints_);
  head.least_rest.assign(joints_ + 1, 0.0);
  head.most_rest.assign(joints_ + 1, 0.0);
  double least = 0.0, most = 0.0;  // in joint order, as Lattice::squared_distance
  for (std::size_t j = 0; j < joints_; ++j) {
    std::array<Choice, 3>& choices = head.choices[j];
    for (int change = -1; change <= 1; ++change) {
      const int index = node[j] + change;
      choices[static_cast<std::size_t>(change + 1)] = {
          lattice_->distance_term(static_cast<Eigen::Index>(j), index), NodeSet::hash_term(j, index), index};
    }
    std::sort(choices.begin(), choices.end(), [](const Choice& a, const Choice& b) {
      return std::tie(a.term, a.index) < std::tie(b.term, b.index);
    });
    least += choices[0].term, most += choices[2].term;
  }
  for (std::size_t j = joints_; j-- > 0;) {
    head.least_rest[j] = head.least_rest[j + 1] + head.choices[j][0].term;
    head.most_rest[j] = head.most_rest[j + 1] + head.choices[j][2].term;
  }
  least_ = head_count_ == 1 ? least : std::min(least_, least);
  most_ = std::max(most_, most);
  most_ways_ = std::max<std::size_t>(4096, 512 * head_count_);
}

/// The next band: it holds a few more neighbours, then ever more, up to eight times as many as before, by the
/// volume of a simplex in n dimensions: the first band is a good guess, as a rule.
void NeighbourQueue::widen() {
  const Head& first = heads_.front();
  const double n = static_cast<double>(std::max<std::size_t>(joints_, 1));
  begin_ = end_;
  if (band_ <= 0.0)
    band_ = (first.most_rest[0] - first.least_rest[0]) / (4.0 * n);
  else if (begin_ >= 0.0)
    band_ *= std::exp2(std::min<double>(++widened_, 3.0) / n);
  end_ = least_ + band_;
  if (!(end_ > begin_)) end_ = most_;  // no such small difference in floating point
}

void NeighbourQueue::fill() {
  while (next_ == entries_.size() && head_count_ > 0 && end_ < most_) {
    widen();
    while (!enumerate_band()) {  // too many: a narrower band, as long as there is one
      const double low = std::max(begin_, least_), narrower = low + (end_ - low) / 4.0;
      most_ways_ = narrower > low && narrower < end_ ? most_ways_ : std::numeric_limits<std::size_t>::max();
      if (narrower > low) end_ = std::min(end_, narrower);
      band_ = end_ - least_;
    }
    sort_entries();
  }
}

/// By distance, then hash: into buckets by distance first, which nearly sorts them.
void NeighbourQueue::sort_entries() {
  const auto by_rank = [](const Entry& a, const Entry& b) {
    if (a.squared_distance != b.squared_distance) return a.squared_distance < b.squared_distance;
    return a.hash != b.hash ? a.hash < b.hash : a.first_way < b.first_way;
  };
  const double low = std::max(begin_, least_), width = end_ - low;
  const std::size_t buckets = entries_.size();
  const double scale = static_cast<double>(buckets) / width;
  if (buckets < 8 || !std::isfinite(scale)) {
    std::sort(entries_.begin(), entries_.end(), by_rank);
    return;
  }
  const auto bucket_of = [&](const Entry& entry) {  // rises with the distance, as rounding does
    const double place = std::max(entry.squared_distance - low, 0.0) * scale;
    return place < static_cast<double>(buckets) ? static_cast<std::size_t>(place) : buckets - 1;
  };
  bucket_ends_.assign(buckets + 1, 0);
  for (const Entry& entry : entries_) ++bucket_ends_[bucket_of(entry) + 1];
  for (std::size_t i = 1; i <= buckets; ++i) bucket_ends_[i] += bucket_ends_[i - 1];
  unsorted_.swap(entries_);
  entries_.resize(unsorted_.size());
  for (const Entry& entry : unsorted_) entries_[bucket_ends_[bucket_of(entry)]++] = entry;
  // Each bucket now ends where bucket_ends_ says.
  for (std::size_t i = 0, begin = 0; i < buckets; begin = bucket_ends_[i++]) {
    const auto at = entries_.begin() + static_cast<std::ptrdiff_t>(begin);
    const auto end = entries_.begin() + static_cast<std::ptrdiff_t>(bucket_ends_[i]);
    if (end - at > 1) std::sort(at, end, by_rank);
  }
}

/// False when the band holds so many that memory would not be O(k) any more.
bool NeighbourQueue::enumerate_band() {
  entries_.clear();
  nodes_.clear();
  ways_.clear();
  next_ = 0;
  std::fill(slots_.begin(), slots_.end(), none);
  for (head_ = 0; head_ < head_count_; ++head_) {
    enumerate(heads_[head_], 0, 0.0, 0, 0);
    if (ways_.size() > most_ways_) return false;
  }
  return true;
}

/// Whether the node under enumeration is that of the entry.
bool NeighbourQueue::is_node_of(const Entry& entry) const {
  if (joints_ > ranked_joints)
    return std::equal(node_.begin(), node_.end(), nodes_.begin() + static_cast<std::ptrdiff_t>(entry.ranks));
  const Head& head = first_head(entry);
  for (std::size_t j = 0; j < joints_; ++j) {
    if (head.index(entry.ranks, j) != node_[j]) return false;
  }
  return true;
}

void NeighbourQueue::grow_slots() {
  slots_.assign(std::max<std::size_t>(64, 2 * slots_.size()), none);
  for (std::uint32_t i = 0; i < entries_.size(); ++i) {
    std::size_t slot = NodeSet::mixed(entries_[i].hash) & (slots_.size() - 1);
    while (slots_[slot] != none) slot = (slot + 1) & (slots_.size() - 1);
    slots_[slot] = i;
  }
}

/// One more way to the node under enumeration, from the head under enumeration.
void NeighbourQueue::add_way(double sum, std::uint64_t hash, std::uint64_t ranks) {
  if (2 * (entries_.size() + 1) > slots_.size()) grow_slots();
  const auto way = static_cast<std::uint32_t>(ways_.size());
  ways_.push_back({head_, none});
  std::size_t slot = NodeSet::mixed(hash) & (slots_.size() - 1);
  for (; slots_[slot] != none; slot = (slot + 1) & (slots_.size() - 1)) {
    Entry& entry = entries_[slots_[slot]];
    if (entry.hash != hash || !is_node_of(entry)) continue;
    ways_[entry.last_way].next = way;
    entry.last_way = way;
    return;
  }
  slots_[slot] = static_cast<std::uint32_t>(entries_.size());
  if (joints_ > ranked_joints) {
    ranks = nodes_.size();
    nodes_.insert(nodes_.end(), node_.begin(), node_.end());
  }
  entries_.push_back({sum, hash, ranks, way, way});
}

/// All neighbours of the head within the band whose joints before `joint` are chosen already.
void NeighbourQueue::enumerate(const Head& head, std::size_t joint, double sum, std::uint64_t hash,
                               std::uint64_t ranks) {
  if (closed_ != nullptr && closed_->is_closed(node_.data(), joint, hash)) return;
  if (joint == joints_) {
    if (sum > begin_ && sum <= end_) add_way(sum, hash, ranks);
    return;
  }
  const double highest = end_ * (1.0 + rounding) - head.least_rest[joint + 1];
  const double lowest = begin_ * (1.0 - rounding) - head.most_rest[joint + 1];
  for (std::uint64_t rank = 0; rank < 3 && ways_.size() <= most_ways_; ++rank) {
    const Choice& choice = head.choices[joint][rank];
    const double next = sum + choice.term;
    if (next > highest) return;
    if (next < lowest || (joint + 1 == joints_ && !(next > begin_ && next <= end_))) continue;
    node_[joint] = choice.index;
    enumerate(head, joint + 1, next, hash + choice.hash, ranks | rank << (2 * joint) % 64);
  }
}

bool NeighbourQueue::empty() {
  if (next_ == entries_.size()) fill();
  return next_ == entries_.size();
}

double NeighbourQueue::next_squared_distance() {
  return empty() ? std::numeric_limits<double>::infinity() : entries_[next_].squared_distance;
}

void NeighbourQueue::pop(Neighbour& neighbour) {
  if (empty()) throw std::logic_error("beam: no neighbour is left");
  const Entry& first = entries_[next_++];
  neighbour.squared_distance = last_ = first.squared_distance;
  neighbour.node.resize(joints_);
  const Head& head = first_head(first);
  for (std::size_t j = 0; j < joints_; ++j)
    neighbour.node[j] = joints_ > ranked_joints ? nodes_[first.ranks + j] : head.index(first.ranks, j);
  neighbour.heads.clear();
  for (std::uint32_t way = first.first_way; way != none; way = ways_[way].next)
    neighbour.heads.push_back(heads_[ways_[way].head].number);
  popped_ += neighbour.heads.size();
}

Neighbour NeighbourQueue::pop() {
  Neighbour neighbour;
  pop(neighbour);
  return neighbour;
}

}  // namespace clearway
