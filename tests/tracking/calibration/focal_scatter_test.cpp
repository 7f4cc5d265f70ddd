#include "tracking/calibration/focal_scatter.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

namespace clearway {
namespace focal_scatter_test {

std::vector<BundleFit::FocalStep> drawn_steps(double scatter, unsigned seed, int count) {
  std::mt19937 random(seed);
  std::uniform_real_distribution<double> unit(0.0, 1.0);
  std::normal_distribution<double> normal;
  std::vector<BundleFit::FocalStep> steps;
  for (int i = 0; i < count; ++i) {
    const double sigma = 0.001 + 0.004 * unit(random);
    steps.push_back({0.01 + scatter * normal(random) + sigma * normal(random), sigma});
  }
  return steps;
}

TEST(FocalScatter, is_none_where_noise_explains_the_differences) {
  int seen = 0, likely = 0;
  for (unsigned seed = 1; seed <= 400; ++seed) {
    const FocalScatter found = focal_scatter(drawn_steps(0.0, seed, 25));
    EXPECT_FALSE(found.is_certain) << seed;
    seen += found.sigma > 0.0;
    likely += found.is_likely;
  }
  EXPECT_NEAR(seen, 20, 18);  // four standard deviations of a binomial distribution
  EXPECT_LT(likely, 4 + 8);
  EXPECT_EQ(focal_scatter({}).sigma, 0.0);
  EXPECT_EQ(focal_scatter({{0.1, 0.001}}).sigma, 0.0);
  EXPECT_EQ(focal_scatter({{0.1, 0.001}, {}}).sigma, 0.0);
}

TEST(FocalScatter, is_found_where_there_is_some) {
  for (unsigned seed = 1; seed <= 20; ++seed) {
    const FocalScatter found = focal_scatter(drawn_steps(0.01, seed, 100));
    EXPECT_TRUE(found.is_certain) << seed;
    EXPECT_NEAR(found.sigma, 0.01, 0.003) << seed;
  }
}

}  // namespace focal_scatter_test
}  // namespace clearway
