#include "datasets/ros/stamp_order.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <random>

namespace clearway {
namespace stamp_order_test {

/// Messages of 100 bytes in two topics, of which each begins with its number.
class MemoryBag final : public MessageBag {
 public:
  explicit MemoryBag(std::size_t count) : messages_(count, std::vector<std::uint8_t>(100)) {
    for (std::size_t i = 0; i < count; ++i) messages_[i][0] = static_cast<std::uint8_t>(i);
  }
  void visit(const std::vector<bool>& topics, const std::function<bool(const BagMessage&)>& take) override {
    ++visits;
    for (std::size_t i = 0; i < messages_.size(); ++i) {
      if (topics[1] && i % 3 == 0) take({1, 0.0, messages_[i]});
      std::vector<std::uint8_t> passing = messages_[i];
      take({0, static_cast<double>(i), passing});
      std::fill(passing.begin(), passing.end(), 0xff);  // bytes hold until the next message only
    }
  }
  std::optional<double> first_time() const override { return 0.0; }
  std::uint64_t offset() const override { return 0; }
  std::size_t visits = 0;

 private:
  std::vector<std::vector<std::uint8_t>> messages_;
};

struct Taken {
  std::vector<std::size_t> numbers;
  std::size_t visits = 0;
};

Taken take_all(const std::vector<double>& stamps, std::size_t most_held) {
  MemoryBag bag(stamps.size());
  Taken taken;
  visit_by_stamp(bag, {true, true}, {true, false}, stamps, most_held, [&](const BagMessage& message) {
    EXPECT_EQ(message.topic, 0U);
    EXPECT_EQ(message.bytes.size(), 100U);
    EXPECT_EQ(message.bytes[0], message.time) << "its own bytes and time";
    taken.numbers.push_back(message.bytes[0]);
  });
  taken.visits = bag.visits;
  return taken;
}

std::vector<std::size_t> sorted_by(const std::vector<double>& stamps) {
  std::vector<std::size_t> numbers(stamps.size());
  for (std::size_t i = 0; i < numbers.size(); ++i) numbers[i] = i;
  std::stable_sort(numbers.begin(), numbers.end(), [&](auto a, auto b) { return stamps[a] < stamps[b]; });
  return numbers;
}

TEST(StampOrder, IsThatOfAStableSortHoweverFewBytesAreHeld) {
  std::mt19937 random(4);
  for (int trial = 0; trial < 60; ++trial) {
    std::vector<double> stamps(1 + random() % 120);
    for (double& stamp : stamps) stamp = static_cast<double>(random() % 40);  // many are equal
    for (const std::size_t most_held : {0, 99, 700, 100000})
      EXPECT_EQ(take_all(stamps, most_held).numbers, sorted_by(stamps)) << trial << ", " << most_held;
  }
}

TEST(StampOrder, ReadsABagInOrderOnceAndAReversedOneAsOftenAsItsBytesAsk) {
  std::vector<double> stamps(100);
  for (std::size_t i = 0; i < 100; ++i) stamps[i] = static_cast<double>(i);
  EXPECT_EQ(take_all(stamps, 0).visits, 1U);
  std::reverse(stamps.begin(), stamps.end());
  EXPECT_EQ(take_all(stamps, 0).visits, 100U);
  EXPECT_EQ(take_all(stamps, 900).visits, 10U);  // nine are held, the tenth is taken as it comes
  EXPECT_EQ(take_all(stamps, 100000).visits, 1U);
}

}  // namespace stamp_order_test
}  // namespace clearway
