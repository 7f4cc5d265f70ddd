#include "planning/problem/limit_rounding.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <numbers>

namespace clearway {
namespace limit_rounding_test {

Joint joint_of(double lower, double upper) {
  Joint joint;
  joint.lower = lower;
  joint.upper = upper;
  return joint;
}

TEST(LimitRounding, OfSinglePrecisionIsDrawnToTheLimit) {
  const Joint whole = joint_of(-std::numbers::pi, std::numbers::pi);
  const double rounded = std::numbers::pi_v<float>;
  EXPECT_GT(rounded, std::numbers::pi);
  EXPECT_EQ(drawn_to_limit(whole, rounded), std::numbers::pi);
  EXPECT_EQ(drawn_to_limit(whole, -rounded), -std::numbers::pi);
  EXPECT_EQ(drawn_to_limit(joint_of(0.0, 2.0), 2.0 + 1e-10), 2.0);
  EXPECT_EQ(drawn_to_limit(joint_of(0.0, 2.0), -1e-10), 0.0);
}

TEST(LimitRounding, WhatIsInsideOrFartherBeyondStaysAsItIs) {
  const Joint joint = joint_of(0.0, 2.0), far = joint_of(-100.0, 100.0);
  for (const double value : {1.9999999999, 0.0, 2.0, 2.000001, -2e-9, 7.0})
    EXPECT_EQ(drawn_to_limit(joint, value), value);
  EXPECT_EQ(drawn_to_limit(far, 100.0 + 0.9e-6), 100.0);
  EXPECT_EQ(drawn_to_limit(far, 100.0 + 2e-6), 100.0 + 2e-6);
  const double infinity = std::numeric_limits<double>::infinity();
  EXPECT_EQ(drawn_to_limit(joint_of(-infinity, infinity), 1e5), 1e5);
  EXPECT_TRUE(std::isnan(drawn_to_limit(joint, std::nan(""))));
}

}  // namespace limit_rounding_test
}  // namespace clearway
