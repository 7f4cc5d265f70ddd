#include "datasets/descriptions/shake.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <complex>
#include <numbers>
#include <vector>

namespace clearway {
namespace shake_test {

constexpr double rate = 100.0, seconds = 60.0;

/// Power of a signal in each bin of 1/`seconds` Hz, by the definition of the Fourier transform.
double power_between(const std::vector<double>& signal, double low_hz, double high_hz) {
  double power = 0.0;
  for (double hz = low_hz; hz < high_hz; hz += 1.0 / seconds) {
    std::complex<double> sum = 0.0;
    for (std::size_t i = 0; i < signal.size(); ++i)
      sum += signal[i] * std::polar(1.0, -2.0 * std::numbers::pi * hz * static_cast<double>(i) / rate);
    power += 2.0 * std::norm(sum / static_cast<double>(signal.size()));
  }
  return power;
}

TEST(Shake, HasTheStatedRootMeanSquareAboutEachAxisAndNothingOutsideItsBand) {
  const Shake shake{0.0005, 0.002, 6, 12};
  const ShakeMotion motion(shake, 4, 9);
  for (int axis = 0; axis < 6; ++axis) {
    std::vector<double> signal;
    double squares = 0.0;
    for (double time = 0.0; time < seconds; time += 1.0 / rate) {
      signal.push_back(axis < 3 ? motion.shift(time)[axis] : motion.turn(time)[axis - 3]);
      squares += signal.back() * signal.back();
    }
    const double expected = axis < 3 ? shake.shift : shake.turn;
    const double mean_square = squares / static_cast<double>(signal.size());
    EXPECT_NEAR(std::sqrt(mean_square), expected, 0.05 * expected) << axis;
    const double inside = power_between(signal, 5.9, 12.1);
    EXPECT_NEAR(inside, mean_square, 0.03 * mean_square) << axis;
  }
}

TEST(Shake, IsAnotherOneForEachSeedAndStreamAndTheSameForTheSame) {
  const Shake shake{0.001, 0.001, 1, 5};
  const ShakeMotion first(shake, 4, 9);
  EXPECT_EQ(first.shift(1.7), ShakeMotion(shake, 4, 9).shift(1.7));
  EXPECT_GT((first.shift(1.7) - ShakeMotion(shake, 5, 9).shift(1.7)).norm(), 1e-5);
  EXPECT_GT((first.turn(1.7) - ShakeMotion(shake, 4, 8).turn(1.7)).norm(), 1e-5);
  EXPECT_GT((first.shift(1.7) - first.turn(1.7)).norm(), 1e-5);
}

TEST(Shake, OfNothingIsExactlyStill) {
  const ShakeMotion still(Shake{}, 1, 1);
  EXPECT_EQ(still.shift(0.3), Eigen::Vector3d(0, 0, 0));
  EXPECT_EQ(still.turn(0.3), Eigen::Vector3d(0, 0, 0));
}

}  // namespace shake_test
}  // namespace clearway
