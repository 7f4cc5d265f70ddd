#include "planning/robot/last_made.hpp"

#include <gtest/gtest.h>

#include <atomic>
#include <thread>
#include <vector>

namespace clearway {
namespace last_made_test {

/// Squares of numbers, and how many were computed.
struct Squares {
  struct Square {
    int of = 0, is = 0;
  };

  std::shared_ptr<const Square> get(int number) {
    return last.get([&](const Square& made) { return made.of == number; },
                    [&] {
                      ++made;
                      return Square{number, number * number};
                    });
  }

  LastMade<Square> last;
  std::atomic<int> made = 0;
};

TEST(LastMade, TheEightAskedForLastAreMadeOnce) {
  Squares squares;
  for (int round = 0; round < 3; ++round)
    for (int number = 0; number < 8; ++number) EXPECT_EQ(squares.get(number)->is, number * number);
  EXPECT_EQ(squares.made, 8);
  squares.get(0);
  squares.get(8);  // 1 goes: 0 was asked for after it
  EXPECT_EQ(squares.made, 9);
  squares.get(0);
  EXPECT_EQ(squares.made, 9);
  const auto again = squares.get(1);
  EXPECT_EQ(squares.made, 10);
  for (int number = 20; number < 40; ++number) squares.get(number);
  EXPECT_EQ(again->is, 1);  // whoever has it keeps it
}

TEST(LastMade, ManyThreadsGetWhatTheyAskFor) {
  Squares squares;
  std::atomic<int> wrong = 0;
  std::vector<std::thread> threads;
  for (int thread = 0; thread < 4; ++thread) {
    threads.emplace_back([&, thread] {
      for (int i = 0; i < 3000; ++i) {
        const int number = (i * (thread + 1)) % 12;
        wrong += squares.get(number)->is != number * number;
      }
    });
  }
  for (std::thread& thread : threads) thread.join();
  EXPECT_EQ(wrong, 0);
}

}  // namespace last_made_test
}  // namespace clearway
