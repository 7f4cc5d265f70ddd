#include "mapping/system/parallel.hpp"

#include <gtest/gtest.h>
#include <sys/wait.h>
#include <unistd.h>

#include <atomic>
#include <mutex>
#include <set>
#include <stdexcept>
#include <thread>
#include <vector>

namespace clearway {
namespace parallel_test {

TEST(Parallel, EachIndexIsCalledOnceWhateverWasAskedForBefore) {
  for (const std::size_t threads : {1U, 3U, 2U, 5U, 1U, 4U}) {
    for (int round = 0; round < 200; ++round) {
      std::vector<std::atomic<int>> calls(threads);
      parallel(threads, [&](std::size_t index) { ++calls.at(index); });
      for (const auto& count : calls) ASSERT_EQ(count, 1);
    }
  }
}

TEST(Parallel, TheCallerIsTheFirstAndHelpersStayTheSame) {
  std::mutex guard;
  std::set<std::thread::id> others;
  for (int round = 0; round < 50; ++round) {
    parallel(3, [&](std::size_t index) {
      const std::lock_guard lock(guard);
      if (index == 0) return;
      others.insert(std::this_thread::get_id());
    });
  }
  EXPECT_EQ(others.size(), 2U);
  EXPECT_FALSE(others.contains(std::this_thread::get_id()));
}

TEST(Parallel, CallersOnThreadsOfTheirOwnDoNotDisturbEachOther) {
  std::atomic<int> sum{0};
  const auto call = [&] {
    for (int round = 0; round < 300; ++round) parallel(3, [&](std::size_t) { ++sum; });
  };
  std::thread a(call), b(call);
  a.join();
  b.join();
  EXPECT_EQ(sum, 2 * 300 * 3);
}

TEST(Parallel, WhatIsThrownArrivesAfterAllHaveReturned) {
  for (const std::size_t thrower : {0U, 1U, 2U}) {
    std::atomic<int> returned{0};
    const auto work = [&](std::size_t index) {
      if (index == thrower) throw std::runtime_error("on purpose");
      ++returned;
    };
    EXPECT_THROW(parallel(3, work), std::runtime_error);
    EXPECT_EQ(returned, 2);
  }
}

TEST(Parallel, AForkedProcessHasHelpersOfItsOwn) {
  std::atomic<int> calls{0};
  parallel(2, [&](std::size_t) { ++calls; });
  const pid_t child = fork();
  ASSERT_GE(child, 0);
  if (child == 0) {
    alarm(20);
    parallel(2, [&](std::size_t) { ++calls; });
    _exit(calls == 4 ? 0 : 1);
  }
  int status = 0;
  waitpid(child, &status, 0);
  EXPECT_EQ(status, 0);
}

}  // namespace parallel_test
}  // namespace clearway
