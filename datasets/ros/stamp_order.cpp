#include "datasets/ros/stamp_order.hpp"

#include <algorithm>
#include <cstdint>
#include <iterator>
#include <map>
#include <numeric>

namespace clearway {
namespace {

/// The turn of each message: its place in the order of stamps.
std::vector<std::size_t> turns_of(std::span<const double> stamps) {
  std::vector<std::size_t> order(stamps.size()), turns(stamps.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::stable_sort(order.begin(), order.end(),
                   [&](std::size_t a, std::size_t b) { return stamps[a] < stamps[b]; });
  for (std::size_t turn = 0; turn < order.size(); ++turn) turns[order[turn]] = turn;
  return turns;
}

/// Messages that came before their turn.
class HeldMessages {
 public:
  explicit HeldMessages(std::size_t most_bytes) : most_bytes_(most_bytes) {}

  void hold(std::size_t turn, const BagMessage& message) {
    bytes_ += message.bytes.size();
    held_[turn] = {message, {message.bytes.begin(), message.bytes.end()}};
    while (bytes_ > most_bytes_) drop(std::prev(held_.end()));
  }
  bool has(std::size_t turn) const { return !held_.empty() && held_.begin()->first == turn; }
  void take_first(const std::function<void(const BagMessage&)>& take) {
    Held& first = held_.begin()->second;
    first.message.bytes = first.bytes;
    take(first.message);
    drop(held_.begin());
  }

 private:
  struct Held {
    BagMessage message;
    std::vector<std::uint8_t> bytes;
  };
  void drop(std::map<std::size_t, Held>::iterator held) {
    bytes_ -= held->second.bytes.size();
    held_.erase(held);
  }

  std::map<std::size_t, Held> held_;  ///< by their turn
  std::size_t bytes_ = 0, most_bytes_;
};

}  // namespace

void visit_by_stamp(MessageBag& bag, const std::vector<bool>& topics, const std::vector<bool>& stamped,
                    std::span<const double> stamps, std::size_t most_held,
                    const std::function<void(const BagMessage&)>& take) {
  const std::vector<std::size_t> turns = turns_of(stamps);
  for (std::size_t next = 0, before = turns.size(); next < turns.size() && next != before;) {
    before = next;  // a bag that changed while it was read may not have the next message any more
    std::size_t number = 0;
    HeldMessages held(most_held);
    bag.visit(topics, [&](const BagMessage& message) {
      if (!stamped[message.topic]) return true;
      if (number == turns.size()) return false;
      const std::size_t turn = turns[number++];
      if (turn > next) held.hold(turn, message);
      if (turn != next) return true;
      take(message);
      for (++next; held.has(next); ++next) held.take_first(take);
      return true;
    });
  }
}

}  // namespace clearway
