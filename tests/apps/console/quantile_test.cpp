#include "apps/console/quantile.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "tests/worlds/random_world.hpp"

namespace clearway {
namespace quantile_test {

TEST(Quantile, IsTheLeastValueWithThatShareAtOrBelowIt) {
  Random random(3);
  for (int round = 0; round < 300; ++round) {
    std::vector<double> values;
    for (int i = random.below(20); i >= 0; --i) values.push_back(static_cast<double>(random.below(9)));
    const double p = std::array{0.0, 0.25, 0.5, 0.95, 1.0}[static_cast<std::size_t>(random.below(5))];
    const double found = quantile(values, p);
    const auto share = [&](const auto& counts) {
      return static_cast<double>(std::count_if(values.begin(), values.end(), counts)) /
             static_cast<double>(values.size());
    };
    EXPECT_NE(std::find(values.begin(), values.end(), found), values.end());
    EXPECT_GE(share([&](double v) { return v <= found; }), p);
    EXPECT_LE(share([&](double v) { return v < found; }), p);
  }
  EXPECT_TRUE(std::isnan(quantile({}, 0.5)));
}

}  // namespace quantile_test
}  // namespace clearway
