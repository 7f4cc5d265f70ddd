#include "mapping/field/zero_memory.hpp"

#include <gtest/gtest.h>

#include <algorithm>

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

}  // namespace zero_memory_test
}  // namespace clearway
