#include "mapping/field/zero_memory.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <random>
#include <thread>
#include <vector>

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

}  // namespace zero_memory_test
}  // namespace clearway
