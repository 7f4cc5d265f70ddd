#include "planning/beam/neighbour_queue.hpp"

#include <algorithm>
#include <bit>
#include <cmath>
#include <limits>
#include <stdexcept>

namespace clearway {
namespace {

constexpr double sum_rounding = 1e-12;  ///< of sums of terms in another order, relative

}  // namespace

void NeighbourQueue::restart(double band) {
  numbers_.clear();
  group_count_ = 0;
  entries_.clear();
  ways_.clear();
  next_ = 0;
  popped_ = enumerated_ = 0;
  last_ = 0.0;
  band_ = band;
  begin_ = end_ = -1.0;
  widened_ = 0;
  has_begun_ = was_stopped_ = false;
}

void NeighbourQueue::add_head(int number, const LatticeIndex& node) {
  if (has_begun_) throw std::logic_error("beam: a head is added to neighbours that are being taken");
  joints_ = node.size();
  if (numbers_.size() % FrontierBatch::most == 0) {
    if (group_count_ == groups_.size()) groups_.emplace_back();
    groups_[group_count_++].clear();
  }
  numbers_.push_back(number);
  groups_[group_count_ - 1].add(node, *lattice_);
}

void NeighbourQueue::begin() {
  has_begun_ = true;
  node_.resize(joints_);
  most_ways_ = std::max<std::size_t>(4096, 64 * numbers_.size());
  for (std::size_t i = 0; i < group_count_; ++i) {
    groups_[i].finish();
    least_ = i == 0 ? groups_[i].nearest() : std::min(least_, groups_[i].nearest());
    most_ = i == 0 ? groups_[i].farthest() : std::max(most_, groups_[i].farthest());
  }
}

/// The next band: it holds a few more neighbours, then ever more, up to eight times as many as before, by the
/// volume of a simplex in n dimensions: the first band is a good guess, as a rule.
void NeighbourQueue::widen() {
  const double n = static_cast<double>(std::max<std::size_t>(joints_, 1));
  begin_ = end_;
  if (band_ <= 0.0)
    band_ = (groups_.front().farthest() - groups_.front().nearest()) / (4.0 * n);
  else if (begin_ >= 0.0)
    band_ *= std::exp2(std::min<double>(++widened_, 3.0) / n);
  end_ = least_ + band_;
  if (!(end_ > begin_)) end_ = most_;  // no such small difference in floating point
}

void NeighbourQueue::fill() {
  if (!has_begun_) begin();
  while (next_ == entries_.size() && group_count_ > 0 && end_ < most_ && !was_stopped_) {
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
  slots_.assign(std::bit_ceil(2 * entries_.size() + 64), none);  // as large as the last one needed
  entries_.clear();
  nodes_.clear();
  ways_.clear();
  next_ = 0;
  for (group_ = 0; group_ < group_count_; ++group_) {
    enumerate(0, 0.0, 0, groups_[group_].all());
    if (ways_.size() > most_ways_) return false;
  }
  return true;
}

/// Whether the node under enumeration is that of the entry.
bool NeighbourQueue::is_node_of(const Entry& entry) const {
  return std::equal(node_.begin(), node_.end(),
                    nodes_.begin() + static_cast<std::ptrdiff_t>(entry.node * joints_));
}

void NeighbourQueue::grow_slots() {
  slots_.assign(std::max<std::size_t>(64, 2 * slots_.size()), none);
  for (std::uint32_t i = 0; i < entries_.size(); ++i) {
    std::size_t slot = NodeSet::mixed(entries_[i].hash) & (slots_.size() - 1);
    while (slots_[slot] != none) slot = (slot + 1) & (slots_.size() - 1);
    slots_[slot] = i;
  }
}

/// One more way to the node under enumeration, from heads of the group under enumeration.
void NeighbourQueue::add_way(double sum, std::uint64_t hash, std::uint64_t heads) {
  if (2 * (entries_.size() + 1) > slots_.size()) grow_slots();
  const auto way = static_cast<std::uint32_t>(ways_.size());
  ways_.push_back({heads, group_, none});
  std::size_t slot = NodeSet::mixed(hash) & (slots_.size() - 1);
  for (; slots_[slot] != none; slot = (slot + 1) & (slots_.size() - 1)) {
    Entry& entry = entries_[slots_[slot]];
    if (entry.hash != hash || !is_node_of(entry)) continue;
    ways_[entry.last_way].next = way;
    entry.last_way = way;
    return;
  }
  const auto number = static_cast<std::uint32_t>(entries_.size());
  slots_[slot] = number;
  nodes_.insert(nodes_.end(), node_.begin(), node_.end());
  entries_.push_back({sum, hash, number, way, way});
}

/// All neighbours within the band, of these heads of the group, whose joints before `joint` are chosen.
void NeighbourQueue::enumerate(std::size_t joint, double sum, std::uint64_t hash, std::uint64_t heads) {
  constexpr std::uint64_t nodes_a_look = 1U << 14U;  // at the time
  if (is_stopped_ && ++enumerated_ % nodes_a_look == 0 && is_stopped_()) was_stopped_ = true;
  if (closed_ != nullptr && closed_->is_closed(node_.data(), joint, hash)) return;
  if (joint == joints_) {
    if (sum > begin_ && sum <= end_) add_way(sum, hash, heads);
    return;
  }
  const FrontierBatch& group = groups_[group_];
  const double highest = end_ * (1.0 + sum_rounding), lowest = begin_ * (1.0 - sum_rounding);
  const double beyond = highest - group.least_rest(joint + 1);
  for (const FrontierBatch::Choice& choice : group.choices(joint)) {
    if (ways_.size() > most_ways_ || was_stopped_) return;
    const double next = sum + choice.term;
    if (next > beyond) return;
    std::uint64_t left = heads & choice.heads;
    if (left == 0) continue;
    if (joint + 1 == joints_) {
      if (!(next > begin_ && next <= end_)) continue;
    } else {
      left &= group.that_can_add_at_most(highest - next, joint + 1);
      if (left == 0) continue;
      left &= group.that_can_add_at_least(lowest - next, joint + 1);
      if (left == 0) continue;
    }
    node_[joint] = choice.index;
    enumerate(joint + 1, next, hash + choice.hash, left);
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
  const auto node = nodes_.begin() + static_cast<std::ptrdiff_t>(first.node * joints_);
  neighbour.node.assign(node, node + static_cast<std::ptrdiff_t>(joints_));
  neighbour.heads.clear();
  for (std::uint32_t way = first.first_way; way != none; way = ways_[way].next) {
    const std::size_t begin = ways_[way].group * FrontierBatch::most;
    for (std::uint64_t left = ways_[way].heads; left != 0; left &= left - 1)
      neighbour.heads.push_back(numbers_[begin + static_cast<std::size_t>(std::countr_zero(left))]);
  }
  popped_ += neighbour.heads.size();
}

Neighbour NeighbourQueue::pop() {
  Neighbour neighbour;
  pop(neighbour);
  return neighbour;
}

}  // namespace clearway
