#include "tracking/painting_probe.hpp"

#include <gtest/gtest.h>

#include <limits>
#include <stdexcept>

#include "tests/worlds/tag_scene.hpp"

namespace clearway {
namespace painting_probe_test {

const double kNan = std::numeric_limits<double>::quiet_NaN(),
             kInfinity = std::numeric_limits<double>::infinity();

TEST(PaintedRadius, is_the_ball_less_the_three_errors_of_equation_3) {
  EXPECT_NEAR(painted_radius(0.05, {0.002, 0.005, 0.003, true}, 0.001), 0.04, 1e-15);
  EXPECT_NEAR(painted_radius(0.05, {0.002, 0.005, 0.003}, 0.001), 0.044, 1e-15);
  EXPECT_EQ(painted_radius(0.05, {0.0, 0.0, 0.0}, 0.0), 0.05);
}

TEST(PaintedRadius, is_nothing_when_the_bound_leaves_nothing) {
  EXPECT_EQ(painted_radius(0.05, {0.002, 0.005, 0.003}, 0.045), 0.0);
  EXPECT_EQ(painted_radius(0.05, {0.002, 0.005, 0.003}, 1.0), 0.0);
  EXPECT_EQ(painted_radius(0.05, {0.0, 0.0, 0.0}, kNan), 0.0);
  EXPECT_EQ(painted_radius(0.05, {0.0, 0.0, 0.0}, kInfinity), 0.0);
}

TEST(PaintedRadius, refuses_budgets_that_leave_no_ball_or_are_no_errors) {
  EXPECT_THROW(painted_radius(0.01, {0.002, 0.005, 0.003, true}, 0.0), std::invalid_argument);
  EXPECT_THROW(painted_radius(0.005, {0.002, 0.005, 0.003, true}, 0.0), std::invalid_argument);
  EXPECT_THROW(painted_radius(0.005, {0.002, 0.005, 0.003}, 0.0), std::invalid_argument);
  EXPECT_THROW(painted_radius(0.05, {-0.001, 0.005, 0.003}, 0.0), std::invalid_argument);
  EXPECT_THROW(painted_radius(0.05, {0.001, -1e-9, 0.003}, 0.0), std::invalid_argument);
  EXPECT_THROW(painted_radius(0.05, {0.001, 0.005, kNan}, 0.0), std::invalid_argument);
  EXPECT_THROW(painted_radius(kNan, {0.001, 0.005, 0.003}, 0.0), std::invalid_argument);
  EXPECT_THROW(painted_radius(kInfinity, {}, 0.0), std::invalid_argument);
}

TEST(PaintedRadius, says_in_its_refusal_what_was_subtracted_from_what) {
  try {
    painted_radius(0.006, {0.001, 0.005, 0.001, true}, 0.0);
    FAIL();
  } catch (const std::invalid_argument& refusal) {
    EXPECT_NE(std::string(refusal.what()).find("0.007 m"), std::string::npos) << refusal.what();
    EXPECT_NE(std::string(refusal.what()).find("0.006 m"), std::string::npos) << refusal.what();
  }
}

TEST(PaintingProbe, refuses_a_ball_without_a_place_or_a_size) {
  const PaintingProbe good{scene::cube("probe", 0, 0.03, 0.05), {0, 0, 0.1}, 0.03};
  EXPECT_NO_THROW(good.validate());
  for (double radius : {0.0, -0.03, std::numeric_limits<double>::quiet_NaN()}) {
    PaintingProbe bad = good;
    bad.ball_radius = radius;
    EXPECT_THROW(bad.validate(), std::invalid_argument);
  }
  PaintingProbe lost = good;
  lost.ball_in_probe.y() = std::numeric_limits<double>::infinity();
  EXPECT_THROW(lost.validate(), std::invalid_argument);
}

}  // namespace painting_probe_test
}  // namespace clearway
