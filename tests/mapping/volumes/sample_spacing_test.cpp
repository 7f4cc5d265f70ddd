#include <gtest/gtest.h>

#include "mapping/volumes/volume_quality.hpp"

namespace clearway {
namespace sample_spacing_test {

Sphere at(double x, double radius) { return {{x, 0, 0}, radius}; }

TEST(SampleSpacing, IsTheDistanceBetweenSuccessiveSpheres) {
  const SampleSpacing spacing = sample_spacing({at(0, 0.1), at(0.01, 0.1), at(0.03, 0.05), at(0.06, 0.1)});
  EXPECT_DOUBLE_EQ(spacing.median, 0.02);
  EXPECT_DOUBLE_EQ(spacing.largest, 0.03);
  EXPECT_DOUBLE_EQ(spacing.median_relative, 0.4);
  EXPECT_DOUBLE_EQ(spacing.largest_relative, 0.6);
  EXPECT_TRUE(spacing.thin.empty());
}

TEST(SampleSpacing, NamesPairsThatMeetInASmallCircleOrNotAtAll) {
  // Equal spheres of radius r at distance d meet in a circle of sqrt(r^2 - d^2 / 4): r / 2 at d = sqrt(3) r.
  const SampleSpacing spacing =
      sample_spacing({at(0, 0.1), at(0.173, 0.1), at(0.347, 0.1), at(0.547, 0.1), at(0.847, 0.1)});
  ASSERT_EQ(spacing.thin.size(), 3U);
  EXPECT_EQ(spacing.thin[0].sphere, 2U);
  EXPECT_NEAR(spacing.thin[0].radius, std::sqrt(0.01 - 0.087 * 0.087), 1e-12);
  EXPECT_NEAR(spacing.thin[0].position.x(), 0.26, 1e-12);
  EXPECT_EQ(spacing.thin[1].sphere, 3U);  // they touch
  EXPECT_NEAR(spacing.thin[1].radius, 0.0, 1e-6);
  EXPECT_EQ(spacing.thin[2].sphere, 4U);
  EXPECT_EQ(spacing.thin[2].radius, 0.0);
  EXPECT_NEAR(spacing.thin[2].position.x(), 0.697, 1e-12);
  EXPECT_NEAR(spacing.thin[2].distance, 0.3, 1e-12);
}

TEST(SampleSpacing, ASmallSphereInOrHalfInALargeOneIsNotThin) {
  EXPECT_TRUE(sample_spacing({at(0, 1.0), at(0.5, 0.1), at(1.0, 0.9)}).thin.empty());
  EXPECT_TRUE(sample_spacing({at(0, 1.0), at(0.95, 0.1)}).thin.empty());  // its centre's width lies inside
  EXPECT_EQ(sample_spacing({at(0, 1.0), at(1.095, 0.1)}).thin.size(), 1U);
}

TEST(SampleSpacing, OfFewerThanTwoSpheresIsZero) {
  EXPECT_EQ(sample_spacing({}).largest, 0.0);
  EXPECT_EQ(sample_spacing({at(0, 1)}).median, 0.0);
}

}  // namespace sample_spacing_test
}  // namespace clearway
