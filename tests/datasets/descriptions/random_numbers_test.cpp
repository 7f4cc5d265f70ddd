#include "datasets/descriptions/random_numbers.hpp"

#include <gtest/gtest.h>

#include <array>
#include <set>

namespace clearway {
namespace random_numbers_test {

TEST(RandomNumbers, UniformNumbersFillTheUnitIntervalEvenly) {
  const RandomNumbers random(1, 2);
  std::array<int, 100> bins{};
  for (uint64_t i = 0; i < 1'000'000; ++i) ++bins[static_cast<size_t>(100 * random.uniform(i))];
  double chi_squared = 0;
  for (int count : bins) chi_squared += (count - 10000.0) * (count - 10000.0) / 10000;
  EXPECT_LT(chi_squared, 149);  // 99 degrees of freedom: 1 in 1000
}

TEST(RandomNumbers, GaussianNumbersHaveTheirMomentsAndAreIndependent) {
  const RandomNumbers random(3, 4);
  double sum = 0, squares = 0, fourth = 0, product = 0, neighbours = 0, last = 0;
  constexpr int count = 500'000;
  for (uint64_t i = 0; i < count; ++i) {
    const auto [a, b] = random.gaussian(i);
    sum += a + b;
    squares += a * a + b * b;
    fourth += a * a * a * a + b * b * b * b;
    product += a * b;
    neighbours += a * last;
    last = b;
  }
  EXPECT_NEAR(sum / (2 * count), 0, 0.004);
  EXPECT_NEAR(squares / (2 * count), 1, 0.006);
  EXPECT_NEAR(fourth / (2 * count), 3, 0.05);
  EXPECT_NEAR(product / count, 0, 0.006);
  EXPECT_NEAR(neighbours / count, 0, 0.006);
}

TEST(RandomNumbers, SeedsAndStreamsAndCountersDiffer) {
  std::set<uint64_t> seen;
  for (uint64_t seed = 0; seed < 20; ++seed)
    for (uint64_t stream = 0; stream < 20; ++stream)
      for (uint64_t counter = 0; counter < 100; ++counter)
        seen.insert(RandomNumbers(seed, stream).bits(counter));
  EXPECT_EQ(seen.size(), 40'000u);
}

TEST(RandomNumbers, AreTheSameEverywhere) {
  // Splitmix64's own arithmetic, written out once more.
  const auto mix = [](uint64_t z) {
    z = (z ^ (z >> 30)) * 0xbf58476d1ce4e5b9;
    z = (z ^ (z >> 27)) * 0x94d049bb133111eb;
    return z ^ (z >> 31);
  };
  const uint64_t golden = 0x9e3779b97f4a7c15, key = mix(mix(5 + golden) ^ (7 * golden));
  EXPECT_EQ(RandomNumbers(5, 7).bits(9), mix(key + 10 * golden));
  // The published first number of splitmix64 for state 0: mix(golden).
  EXPECT_EQ(mix(golden), 0xe220a8397b1dcdafu);
}

}  // namespace random_numbers_test
}  // namespace clearway
