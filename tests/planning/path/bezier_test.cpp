// Polynomials in Bezier form against their monomials, which the tests solve for and sum up themselves.
#include "planning/path/bezier.hpp"

#include <gtest/gtest.h>

#include <Eigen/LU>
#include <cmath>
#include <random>

namespace clearway {
namespace bezier_test {

using Vector = Eigen::VectorXd;

/// c0 + c1 t + … with the given values, and as many derivatives, at 0 and at `duration`.
Vector monomials(const Vector& at_begin, const Vector& at_end, double duration) {
  const Eigen::Index k = at_begin.size(), n = 2 * k;
  Eigen::MatrixXd rows = Eigen::MatrixXd::Zero(n, n);
  for (Eigen::Index order = 0; order < k; ++order)
    for (Eigen::Index power = order; power < n; ++power) {
      double factor = 1.0;
      for (Eigen::Index i = 0; i < order; ++i) factor *= static_cast<double>(power - i);
      rows(order, power) = power == order ? factor : 0.0;
      rows(k + order, power) = factor * std::pow(duration, static_cast<double>(power - order));
    }
  Vector values(n);
  values << at_begin, at_end;
  return rows.fullPivLu().solve(values);
}

double value_at(const Vector& monomials, double t) {
  double sum = 0.0;
  for (Eigen::Index i = monomials.size(); i-- > 0;) sum = sum * t + monomials[i];
  return sum;
}

Vector derived(const Vector& monomials) {
  Vector rate(std::max<Eigen::Index>(1, monomials.size() - 1));
  rate.setZero();
  for (Eigen::Index i = 1; i < monomials.size(); ++i) rate[i - 1] = static_cast<double>(i) * monomials[i];
  return rate;
}

/// The Bernstein polynomials summed up.
double value_of(const Bezier& curve, double share) {
  const auto n = static_cast<double>(curve.control.size() - 1);
  double sum = 0.0, choose = 1.0;
  for (std::size_t i = 0; i < curve.control.size(); ++i) {
    const auto k = static_cast<double>(i);
    sum += choose * std::pow(share, k) * std::pow(1.0 - share, n - k) * curve.control[i][0];
    choose *= (n - k) / (k + 1.0);
  }
  return sum;
}

struct Drawn {
  Bezier curve;
  Vector monomials;
};

class Draws {
 public:
  Vector vector(Eigen::Index size) {
    return Vector::NullaryExpr(size, [&] { return number_(random_); });
  }
  /// Of degree 1, 3 or 5.
  Drawn curve(int values) {
    const Vector begin = vector(values), end = vector(values);
    const double h = std::pow(10.0, number_(random_));
    const auto one = [](double value) { return Vector::Constant(1, value); };
    std::vector<Vector> parts;
    for (const Vector& side : {begin, end})
      for (Eigen::Index i = 0; i < 3; ++i) parts.push_back(i < values ? one(side[i]) : Vector());
    const BezierEnd from{parts[0], parts[1], parts[2]}, to{parts[3], parts[4], parts[5]};
    Bezier curve = values == 1   ? linear_between(parts[0], parts[3], h)
                   : values == 2 ? cubic_between(from, to, h)
                                 : quintic_between(from, to, h);
    return {std::move(curve), monomials(begin, end, h)};
  }

 private:
  std::mt19937_64 random_{11};
  std::uniform_real_distribution<double> number_{-1.0, 1.0};
};

constexpr int draws = 300, steps = 400;

TEST(BezierCurve, IsThePolynomialWithTheseEnds) {
  Draws draw;
  for (int i = 0; i < draws; ++i) {
    const auto [curve, own] = draw.curve(1 + i % 3);
    for (int k = 0; k <= 10; ++k)
      EXPECT_NEAR(value_of(curve, k / 10.0), value_at(own, curve.duration * k / 10.0), 1e-10) << i;
    const Bezier rate = derivative(curve), bend = derivative(rate);
    const Vector own_rate = derived(own), own_bend = derived(own_rate);
    for (int k = 0; k <= 10; ++k) {
      const double t = curve.duration * k / 10.0;
      EXPECT_NEAR(value_of(rate, k / 10.0), value_at(own_rate, t), 1e-8 * (1.0 + std::abs(own_rate[0])));
      EXPECT_NEAR(value_of(bend, k / 10.0), value_at(own_bend, t),
                  1e-7 * (1.0 + own_bend.cwiseAbs().maxCoeff()));
    }
  }
}

TEST(BezierCurve, IsTheSameInHalves) {
  Draws draw;
  for (int i = 0; i < draws; ++i) {
    const Bezier curve = draw.curve(1 + i % 3).curve;
    const auto [first, second] = halves(curve);
    EXPECT_EQ(first.duration + second.duration, curve.duration);
    EXPECT_EQ(first.control.back(), second.control.front());
    for (int k = 0; k <= 10; ++k) {
      EXPECT_NEAR(value_of(first, k / 10.0), value_of(curve, k / 20.0), 1e-12);
      EXPECT_NEAR(value_of(second, k / 10.0), value_of(curve, 0.5 + k / 20.0), 1e-12);
    }
  }
}

/// No sample is beyond a peak, and the peak is taken on where it is said to be.
TEST(BezierCurve, PeaksAreTakenOnAndNotExceeded) {
  Draws draw;
  for (int i = 0; i < draws; ++i) {
    const auto [curve, own] = draw.curve(1 + i % 3);
    const BezierPeak high = highest(curve, 0), low = lowest(curve, 0), far = peak(curve, 0);
    EXPECT_NEAR(value_at(own, high.share * curve.duration), high.value, 1e-10);
    EXPECT_NEAR(value_at(own, low.share * curve.duration), low.value, 1e-10);
    EXPECT_EQ(std::abs(far.value), std::max(std::abs(high.value), std::abs(low.value)));
    for (int k = 0; k <= steps; ++k) {
      const double value = value_at(own, curve.duration * k / steps);
      EXPECT_LE(value, high.value + 1e-10);
      EXPECT_GE(value, low.value - 1e-10);
    }
  }
}

TEST(BezierCurve, OfAKnownCubicPeaksWhereItsDerivativeIsZero) {
  // From rest to rest over a way of 1 in 2 s: the greatest speed is 1.5 / 2, the acceleration 6 / 4.
  const Vector zero = Vector::Zero(1), one = Vector::Ones(1);
  const Bezier curve = cubic_between({zero, zero, zero}, {one, zero, zero}, 2.0);
  const BezierPeak speed = peak(derivative(curve), 0);
  EXPECT_NEAR(speed.value, 0.75, 1e-12);
  EXPECT_NEAR(speed.share, 0.5, 1e-6);
  EXPECT_NEAR(std::abs(peak(derivative(derivative(curve)), 0).value), 1.5, 1e-12);
  // Both ends at 0, with velocities of 3 and -3 over 4 s: h v / 4 in the middle.
  const Bezier swing = cubic_between({zero, 3.0 * one, zero}, {zero, -3.0 * one, zero}, 4.0);
  EXPECT_NEAR(peak(swing, 0).value, 3.0, 1e-12);
  EXPECT_EQ(peak(derivative(swing), 0).value, 3.0);
  EXPECT_EQ(highest(linear_between(zero, one, 1.0), 0).share, 1.0);
  EXPECT_EQ(lowest(linear_between(zero, one, 1.0), 0).value, 0.0);
  EXPECT_EQ(derivative(derivative(linear_between(zero, one, 0.5))).control.front()[0], 0.0);
}

}  // namespace bezier_test
}  // namespace clearway
