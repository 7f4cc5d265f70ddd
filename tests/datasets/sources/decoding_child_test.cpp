#include "datasets/sources/decoding_child.hpp"

#include <gtest/gtest.h>
#include <unistd.h>

#include <csignal>
#include <ctime>
#include <string>
#include <vector>

namespace clearway {
namespace decoding_child_test {

constexpr DecodingLimits limits{.memory = 256 << 20, .seconds = 20, .patience = 1};

/// Until `damage` or `end`.
std::vector<ChildMessage> messages_of(const DecodingChild::Work& work) {
  DecodingChild child(limits, -1, work);
  std::vector<ChildMessage> messages;
  do messages.push_back(child.receive());
  while (messages.back().kind != ChildMessage::damage && messages.back().kind != ChildMessage::end);
  return messages;
}

double own_processor_time() { return static_cast<double>(std::clock()) / CLOCKS_PER_SEC; }

TEST(DecodingChild, OneThatWaitsForEverIsEndedAndWhatItSentBeforeIsKept) {
  const auto messages = messages_of([](const ChildReport& report, int) {
    report.send(ChildMessage::object, 7, "whole");
    while (true) ::pause();
  });
  ASSERT_EQ(messages.size(), 2u);
  EXPECT_EQ(messages[0].text, "whole");
  EXPECT_EQ(messages[1].kind, ChildMessage::damage);
  EXPECT_EQ(messages[1].text, "decoding the object did not come to an end");
}

TEST(DecodingChild, OneThatComputesForLongerThanItMayWaitIsNotEnded) {
  const auto messages = messages_of([](const ChildReport& report, int) {
    while (own_processor_time() < 3.0) {
    }
    report.send(ChildMessage::end, 0, "");
  });
  ASSERT_EQ(messages.size(), 1u);
  EXPECT_EQ(messages[0].kind, ChildMessage::end);
}

TEST(DecodingChild, OneThatIsNotAskedForAWhileIsNotEnded) {
  DecodingChild child(limits, -1, [](const ChildReport& report, int) {
    for (int i = 0; i < 100; ++i) report.send(ChildMessage::object, 0, std::string(10'000, 'x'));
    report.send(ChildMessage::end, 0, "");  // the pipe is full long before
  });
  ::sleep(3);
  int objects = 0;
  while (child.receive().kind == ChildMessage::object) ++objects;
  EXPECT_EQ(objects, 100);
}

TEST(DecodingChild, OneThatCrashesIsDamage) {
  const auto messages = messages_of([](const ChildReport&, int) { ::raise(SIGSEGV); });
  ASSERT_EQ(messages.size(), 1u);
  EXPECT_EQ(messages[0].kind, ChildMessage::damage);
  EXPECT_EQ(messages[0].text, "the object crashed the decoder (signal 11)");
}

}  // namespace decoding_child_test
}  // namespace clearway
