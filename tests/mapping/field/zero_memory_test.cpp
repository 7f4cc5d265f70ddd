#include "mapping/field/zero_memory.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <fstream>
#include <new>
#include <random>
#include <thread>
#include <vector>

#if defined(__linux__)
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include "tests/mapping/use_in_forks.hpp"
#endif

namespace clearway {
namespace zero_memory_test {

TEST(ZeroMemory, IsZeroAndItsOwnWhateverItsSize) {
  for (const std::size_t bytes : {1U, 4096U, (1U << 16U) - 1U, 1U << 16U, 10'000'001U}) {
    for (int again = 0; again < 2; ++again) {  // the second time perhaps from what was given back
      const std::span<std::uint8_t> memory = zero_memory(bytes);
      ASSERT_EQ(memory.size(), bytes);
      EXPECT_EQ(std::count(memory.begin(), memory.end(), 0), static_cast<std::ptrdiff_t>(bytes));
      std::fill(memory.begin(), memory.end(), std::uint8_t{255});
      free_zero_memory(memory);
    }
  }
}

TEST(ZeroMemory, OfWhatIsKeptIsZeroAndNobodyElses) {
  const std::array<std::size_t, 6> sizes = {3, 4099, 65'536, 600'003, 3'000'001, (65U << 20U) + 1U};
  const auto use = [&](int seed) {
    std::mt19937 random(seed);
    std::vector<std::span<std::uint8_t>> held;
    for (int turn = 0; turn < 60; ++turn) {
      const auto memory = zero_memory(sizes[random() % sizes.size()]);
      const auto mine = static_cast<std::uint8_t>(1 + seed);
      for (const std::size_t at : {std::size_t{0}, memory.size() / 2, memory.size() - 1}) {
        EXPECT_EQ(memory[at], 0);
        memory[at] = mine;
      }
      held.push_back(memory);
      if (held.size() < 4) continue;
      const auto old = held.front();
      held.erase(held.begin());
      for (const std::size_t at : {std::size_t{0}, old.size() / 2, old.size() - 1}) {
        EXPECT_EQ(old[at], mine);
        old[at] = 0;
      }
      keep_zero_memory(old);
    }
    for (const auto memory : held) free_zero_memory(memory);
  };
  std::vector<std::thread> threads;
  for (int seed = 0; seed < 3; ++seed) threads.emplace_back(use, seed);
  for (std::thread& thread : threads) thread.join();
}

TEST(ZeroMemory, TheLastPiecesWaitAndNoMoreBytesThanAllowed) {
  if (!is_kept(1)) GTEST_SKIP() << "under an address sanitizer no piece waits";
  std::vector<std::span<std::uint8_t>> pieces;
  for (std::size_t i = 0; i <= kept_zero_pieces; ++i) pieces.push_back(zero_memory(5000 + i));
  for (const auto piece : pieces) keep_zero_memory(piece);  // the first is one too many
  for (std::size_t i = 1; i <= kept_zero_pieces; ++i) {
    const auto again = zero_memory(5000 + i);
    EXPECT_EQ(again.data(), pieces[i].data());
    free_zero_memory(again);
  }
  const std::size_t third = kept_zero_bytes / 3;
  const std::array<std::span<std::uint8_t>, 4> large{zero_memory(third), zero_memory(third + 1),
                                                     zero_memory(third + 2), zero_memory(third + 3)};
  for (const auto piece : large) keep_zero_memory(piece);  // the last two fit
  EXPECT_EQ(large[3].data(), zero_memory(third + 3).data());
  EXPECT_EQ(large[2].data(), zero_memory(third + 2).data());
  free_zero_memory(large[3]);
  free_zero_memory(large[2]);
  EXPECT_FALSE(is_kept(kept_zero_bytes + 1));
}

#if defined(__linux__)
TEST(ZeroMemory, AForkedProcessMayUseItWhateverThreadsDid) {
  EXPECT_EQ(use_in_forks([] { keep_zero_memory(zero_memory(100)); }), 100);
}

/// What waits is given up for who gets no memory otherwise.
TEST(ZeroMemory, WhatWaitsIsThereForOtherSizes) {
  if (!is_kept(1)) GTEST_SKIP() << "under an address sanitizer no piece waits";
  const pid_t child = ::fork();
  if (child == 0) {
    const std::size_t half = kept_zero_bytes / 2 - (4U << 20U);
    const auto first = zero_memory(half), second = zero_memory(half + 1);
    keep_zero_memory(first);
    keep_zero_memory(second);
    std::ifstream statm("/proc/self/statm");
    std::size_t pages = 0;
    statm >> pages;
    const rlimit bound{pages * static_cast<std::size_t>(::sysconf(_SC_PAGESIZE)) + half / 2, RLIM_INFINITY};
    ::setrlimit(RLIMIT_AS, &bound);
    try {
      zero_memory(half + 2);
    } catch (const std::bad_alloc&) {
      ::_exit(1);
    }
    ::_exit(0);
  }
  int status = -1;
  ASSERT_EQ(::waitpid(child, &status, 0), child);
  EXPECT_EQ(status, 0);
}
#endif

}  // namespace zero_memory_test
}  // namespace clearway
