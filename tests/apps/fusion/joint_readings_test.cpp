// Readings of joints in other units than radians and metres are noticed, turns that encoders count are not.
#include "apps/fusion/joint_readings.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "tests/datasets/complaint.hpp"

namespace clearway {
namespace joint_readings_test {

Joint joint_of(JointKind kind, double lower, double upper) {
  Joint joint;
  joint.name = "elbow";
  joint.kind = kind;
  joint.lower = lower;
  joint.upper = upper;
  return joint;
}

std::string refusal(const Joint& joint, double value) {
  return complaint([&] { require_possible(joint, value, "readings"); });
}

TEST(JointReadings, DegreesAndMillimetresAreRefused) {
  const Joint elbow = joint_of(JointKind::revolute, -3.14, 3.14);
  EXPECT_EQ(
      refusal(elbow, -90.0),
      "readings: joint 'elbow' reads -90 rad, its limits are -3.14 and 3.14 rad: expected radians; are these "
      "degrees?");
  for (const double value : {0.0, 3.2, -3.2, 3.14 + 2.0 * M_PI, -3.14 - 2.0 * M_PI})
    EXPECT_EQ(refusal(elbow, value), "") << value;
  const Joint finger = joint_of(JointKind::prismatic, 0.0, 0.04);
  EXPECT_NE(refusal(finger, 40.0)
                .find("reads 40 m, its limits are 0 and 0.04 m: expected metres; are these millimetres?"),
            std::string::npos);
  EXPECT_EQ(refusal(finger, 0.041), "");
  EXPECT_EQ(refusal(joint_of(JointKind::prismatic, 0.9, 1.1), 0.2), "")
      << "a way that is narrowed for planning";
  constexpr double endless = std::numeric_limits<double>::infinity();
  EXPECT_EQ(refusal(joint_of(JointKind::revolute, -endless, endless), 500.0), "");
}

TEST(JointReadings, WhatIsBeyondLimitsIsToldWholeTurnsAside) {
  const Joint elbow = joint_of(JointKind::revolute, -1.0, 2.0);
  for (int turns = -1; turns <= 1; ++turns) {
    const double turn = 2.0 * M_PI * turns;
    for (const double value : {-1.0, -1.05, 0.5, 2.0, 2.05})
      EXPECT_FALSE(beyond_limits(elbow, value + turn)) << value << " " << turns;
    for (const double value : {-1.2, 2.2, 3.3})
      EXPECT_TRUE(beyond_limits(elbow, value + turn)) << value << " " << turns;
  }
  EXPECT_TRUE(beyond_limits(joint_of(JointKind::prismatic, 0.0, 0.04), 0.07));
  EXPECT_FALSE(beyond_limits(joint_of(JointKind::prismatic, 0.0, 0.04), 0.05));
  constexpr double endless = std::numeric_limits<double>::infinity();
  EXPECT_FALSE(beyond_limits(joint_of(JointKind::revolute, -endless, endless), 500.0));
}

}  // namespace joint_readings_test
}  // namespace clearway
