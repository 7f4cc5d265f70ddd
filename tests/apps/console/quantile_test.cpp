#include "apps/console/quantile.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "tests/worlds/random_world.hpp"

namespace clearway {
namespace quantile_test {

/// As numpy.quantile gives them.
TEST(Quantile, AgreesWithNumPys) {
  const std::vector<double> values{7, 1, 4, 12, 4, 30};
  EXPECT_DOUBLE_EQ(quantile(values, 0.0), 1.0);
  EXPECT_DOUBLE_EQ(quantile(values, 0.25), 4.0);
  EXPECT_DOUBLE_EQ(quantile(values, 0.5), 5.5);
  EXPECT_DOUBLE_EQ(quantile(values, 0.75), 10.75);
  EXPECT_DOUBLE_EQ(quantile(values, 0.95), 25.5);
  EXPECT_DOUBLE_EQ(quantile(values, 1.0), 30.0);
  EXPECT_DOUBLE_EQ(quantile({3.0}, 0.95), 3.0);
  EXPECT_TRUE(std::isnan(quantile({}, 0.5)));
}

TEST(Quantile, OfAHalfIsTheMedian) {
  Random random(3);
  for (int round = 0; round < 300; ++round) {
    std::vector<double> values;
    for (int i = random.below(20); i >= 0; --i) values.push_back(static_cast<double>(random.below(9)));
    const double found = quantile(values, 0.5);
    std::vector<double> turned;  // the median of the negative values is the negative median
    for (const double value : values) turned.push_back(-value);
    EXPECT_DOUBLE_EQ(quantile(turned, 0.5), -found);
    const auto beyond = [&](const auto& counts) {
      return 2 * std::count_if(values.begin(), values.end(), counts);
    };
    EXPECT_LE(beyond([&](double v) { return v > found; }), static_cast<std::ptrdiff_t>(values.size()));
    EXPECT_LE(beyond([&](double v) { return v < found; }), static_cast<std::ptrdiff_t>(values.size()));
  }
}

TEST(Quantile, OfValuesWithoutBoundIsNoNaN) {
  const double infinity = std::numeric_limits<double>::infinity();
  EXPECT_EQ(quantile({1.0, infinity, infinity}, 0.75), infinity);
  EXPECT_EQ(quantile({1.0, infinity}, 0.5), infinity);
}

}  // namespace quantile_test
}  // namespace clearway
