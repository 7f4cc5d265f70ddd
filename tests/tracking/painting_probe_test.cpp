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

TEST(PaintedRadius, takes_errors_of_nothing_and_refuses_the_first_that_is_none_and_is_never_below_nothing) {
  for (double ErrorBudget::*error : {&ErrorBudget::robot, &ErrorBudget::tracking, &ErrorBudget::modelling}) {
    ErrorBudget budget;
    budget.*error = 0.0;
    EXPECT_NO_THROW(validate(budget, 0.05));
    for (const double bad : {-1e-300, kNan, kInfinity, -kInfinity}) {
      budget.*error = bad;
      EXPECT_THROW(validate(budget, 1e300), std::invalid_argument) << bad;
    }
  }
  const ErrorBudget budget{0.25, 0.125, 0.25};
  EXPECT_THROW(validate(budget, 0.5), std::invalid_argument);
  EXPECT_NO_THROW(validate(budget, std::nextafter(0.5, 1.0)));
  EXPECT_THROW(validate(budget, -1.0), std::invalid_argument);
  EXPECT_EQ(painted_radius(1.0, budget, 0.25), 0.25);
  EXPECT_EQ(painted_radius(1.0, budget, 0.5), 0.0);
  EXPECT_EQ(painted_radius(1.0, budget, 0.75), 0.0);
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
  PaintingProbe blank = good;
  blank.body.tags.clear();
  EXPECT_THROW(blank.validate(), std::invalid_argument);
  PaintingProbe tiny = good;
  tiny.ball_radius = 1e-9;
  EXPECT_NO_THROW(tiny.validate());
  tiny.ball_radius = std::numeric_limits<double>::infinity();
  EXPECT_THROW(tiny.validate(), std::invalid_argument);
  PaintingProbe lost = good;
  lost.ball_in_probe.y() = std::numeric_limits<double>::infinity();
  EXPECT_THROW(lost.validate(), std::invalid_argument);
}

}  // namespace painting_probe_test
}  // namespace clearway
