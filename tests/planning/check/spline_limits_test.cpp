// Points of trajectories at joint limits, and chords of those on straight lines.
#include <gtest/gtest.h>

#include "planning/check/spline_check.hpp"
#include "planning/robot_files/load_robot.hpp"

namespace clearway {
namespace spline_limits_test {

Configuration at(double x, double y) { return Eigen::Vector2d(x, y); }

/// The disc, without a file, from -1 to 1 m in an empty map.
SplineVerdict check(const std::vector<SplinePoint>& points) {
  Robot disc = load_robot("point");
  disc.source.clear();
  for (Joint& joint : disc.joints) joint.lower = -1.0, joint.upper = 1.0;
  return check_splines(disc, Snapshot(), {}, 0.0, points);
}

/// By a nanometre, as files round them.
TEST(SplineLimits, MayBePassedByRounding) {
  for (const double side : {-1.0, 1.0}) {
    for (const double beyond : {0.5e-9, 2e-9}) {
      const SplineVerdict verdict = check({{0.0, at(0, 0)}, {1.0, at(side * (1.0 + beyond), 0.0)}});
      EXPECT_EQ(verdict.path.valid, beyond < 1e-9) << verdict.path.first_contact;
    }
  }
}

/// Of a lone point, too.
TEST(SplineLimits, BindALonePointOnEitherSide) {
  for (const double side : {-1.0, 1.0}) {
    EXPECT_TRUE(check({{0.0, at(0.0, side)}}).path.valid);
    const SplineVerdict verdict = check({{0.0, at(0.0, 1.01 * side)}});
    EXPECT_FALSE(verdict.path.valid);
    EXPECT_NE(verdict.path.first_contact.find("joint y is "), std::string::npos)
        << verdict.path.first_contact;
  }
}

/// In a millisecond rounding may take 1 % of an acceleration's limit, but nothing of what points state.
TEST(SplineLimits, BindAccelerationsThatPointsStateHoweverShortTheEdge) {
  Robot disc = load_robot("point");
  for (Joint& joint : disc.joints) joint.max_acceleration = 1.0;
  const double h = 0.001;
  for (const double stated : {1.0, 1.005, -1.005}) {
    const SplineVerdict verdict =
        check_splines(disc, Snapshot(), {}, 0.0,
                      {{0.0, at(0, 0), at(0, 0), at(0, stated)},
                       {h, at(0, stated * h * h / 2.0), at(0, stated * h), at(0, stated)}});
    EXPECT_EQ(verdict.fault.find("the acceleration of joint y is ") == std::string::npos, stated == 1.0)
        << verdict.fault;
  }
}

TEST(SplineLimits, EdgesThatGoOnStraightAreOneChord) {
  std::vector<SplinePoint> points;
  for (int i = 0; i <= 8; ++i) points.push_back({0.1 * i, at(0.125 * i, 0.0)});
  EXPECT_EQ(check(points).chords.size(), 2U);
  points[3].position[1] = 0.01;
  EXPECT_GT(check(points).chords.size(), 3U);
}

}  // namespace spline_limits_test
}  // namespace clearway
