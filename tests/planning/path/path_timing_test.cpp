#include "planning/path/path_timing.hpp"

#include <gtest/gtest.h>

#include "tests/worlds/random_world.hpp"

namespace clearway {
namespace path_timing_test {

using Eigen::Vector2d;

constexpr double period = 1e-4;

Configuration at(double x, double y) { return Vector2d(x, y); }
Eigen::VectorXd both(double value) { return Eigen::VectorXd::Constant(2, value); }

double duration(const PathSamples& samples) {
  return period * static_cast<double>(samples.positions.size() - 1);
}

TEST(PathTiming, OnOneEdgeIsTheTrapezoidOfTheJointThatBindsMost) {
  // The first joint goes 2 of a 1-per-second, 5-per-second-squared joint: 1/5 s up, 1/5 s down, 1.8 s level.
  const SmoothPath edge = blended_path({at(0, 0), at(2, -1)}, {0, 0});
  EXPECT_NEAR(duration(time_optimal_samples(edge, both(1.0), both(5.0), period)), 2.2, 0.01);
  // A short one is a triangle: 2 sqrt(length / a).
  const SmoothPath brief = blended_path({at(0, 0), at(0.05, 0)}, {0, 0});
  EXPECT_NEAR(duration(time_optimal_samples(brief, both(1.0), both(5.0), period)), 0.2, 0.004);
}

/// Half of a circle's worth of small turns at a speed that a = v^2 / r bounds, against the analytic time.
TEST(PathTiming, OnACircleOfBlendsGoesAsFastAsTheCentripetalAccelerationAllows) {
  std::vector<Configuration> corners;
  constexpr int sides = 60;
  for (int i = 0; i <= 4 * sides; ++i)
    corners.push_back(at(std::cos(i * M_PI / sides), std::sin(i * M_PI / sides)));
  std::vector<double> reach(corners.size(), 0.5 * (corners[1] - corners[0]).norm());
  const PathSamples samples =
      time_optimal_samples(blended_path(corners, reach), both(100.0), both(4.0), period);
  // Each joint bounds its own component: where one joint takes all of the centripetal part, v^2 = 4.
  double fastest = 0.0;
  for (std::size_t k = 1; k < samples.positions.size(); ++k)
    fastest = std::max(fastest, (samples.positions[k] - samples.positions[k - 1]).norm() / period);
  EXPECT_LT(fastest, 2.0 * std::sqrt(std::sqrt(2.0)) + 0.1);  // at 45 degrees both joints share it
  EXPECT_GT(fastest, 1.9);
}

TEST(PathTiming, SamplesOfRandomPathsKeepVelocityAndAcceleration) {
  Random random(3);
  for (int trial = 0; trial < 60; ++trial) {
    const Eigen::Index n = 1 + random.below(7);
    std::vector<Configuration> path;
    for (int i = 0; i < 2 + random.below(12); ++i) {
      Configuration q(n);
      for (double& value : q) value = random.between(-2, 2);
      path.push_back(q);
    }
    std::vector<double> reach(path.size(), 0.0);
    for (std::size_t i = 1; i + 1 < path.size(); ++i)
      reach[i] = random.between(0.02, 0.5) *
                 std::min((path[i] - path[i - 1]).norm(), (path[i + 1] - path[i]).norm());
    Eigen::VectorXd velocity(n), acceleration(n);
    for (double& value : velocity) value = random.between(0.2, 3);
    for (double& value : acceleration) value = random.between(1, 20);
    const SmoothPath smooth = blended_path(path, reach);
    constexpr double step = 1e-3;
    const auto positions = time_optimal_samples(smooth, velocity, acceleration, step).positions;
    EXPECT_EQ(positions.front(), path.front());
    EXPECT_EQ(positions.back(), path.back());
    const auto sample = [&](std::ptrdiff_t k) {
      return positions[static_cast<std::size_t>(
          std::clamp<std::ptrdiff_t>(k, 0, static_cast<std::ptrdiff_t>(positions.size()) - 1))];
    };
    for (std::ptrdiff_t k = -1; k <= static_cast<std::ptrdiff_t>(positions.size()); ++k) {
      const Eigen::VectorXd first = (sample(k + 1) - sample(k)) / step;
      const Eigen::VectorXd second = (sample(k + 1) - 2 * sample(k) + sample(k - 1)) / (step * step);
      ASSERT_LE(first.cwiseAbs().cwiseQuotient(velocity).maxCoeff(), 1.0 + 1e-6) << trial << " " << k;
      ASSERT_LE(second.cwiseAbs().cwiseQuotient(acceleration).maxCoeff(), 1.0 + 1e-6) << trial << " " << k;
    }
  }
}

/// The peak on the short edge is not cut down to what both long edges would have to go at.
TEST(PathTiming, LevelSpeedOnAVeryShortEdgeDoesNotSlowTheLongOnes) {
  const double e = 1e-4;
  const SmoothPath path = blended_path({at(0, 0), at(1, 0), at(1, e), at(2, e)}, {0, 0.3 * e, 0.3 * e, 0});
  const double free = duration(time_optimal_samples(path, both(1.0), both(5.0), period));
  const double level = duration(time_optimal_samples(path, both(1.0), both(5.0), period, 0.05));
  EXPECT_LT(level, 1.5 * free);
}

TEST(PathTiming, AReversalIsPassedWithoutBreakingALimit) {
  const SmoothPath back = blended_path({at(0, 0), at(1, 0), at(0, 0.0)}, {0, 0.5, 0});
  const auto positions = time_optimal_samples(back, both(1.0), both(5.0), 1e-3).positions;
  double farthest = 0.0;
  for (std::size_t k = 1; k + 1 < positions.size(); ++k) {
    farthest = std::max(farthest, positions[k][0]);
    EXPECT_LE((positions[k + 1] - 2 * positions[k] + positions[k - 1]).cwiseAbs().maxCoeff(),
              5e-6 * (1 + 1e-6));
  }
  EXPECT_NEAR(farthest, 0.75, 0.01);  // the parabola turns half way into its reach
}

}  // namespace path_timing_test
}  // namespace clearway
