// Volume and area of unions of spheres against formulas and against counted random points.

#include <gtest/gtest.h>

#include <numbers>

#include "mapping/volumes/sphere_union.hpp"
#include "mapping/voxels/painted_volume.hpp"
#include "tests/worlds/random_map.hpp"

namespace clearway {
namespace sphere_union_test {

using std::numbers::pi;
using worlds::Dice;

double sphere_volume(double r) { return 4.0 / 3.0 * pi * r * r * r; }

/// Lens of two spheres at distance d.
double lens_volume(double a, double b, double d) {
  return pi * (a + b - d) * (a + b - d) * (d * d + 2 * d * (a + b) - 3 * (a - b) * (a - b)) / (12 * d);
}

/// Area of two spheres at distance d that neither covers of the other.
double open_area_of_two(double a, double b, double d) {
  const double cap_a = a - (d * d + a * a - b * b) / (2 * d);
  const double cap_b = b - (d * d + b * b - a * a) / (2 * d);
  return 4 * pi * (a * a + b * b) - 2 * pi * (a * cap_a + b * cap_b);
}

void expect_volume(const std::vector<Sphere>& spheres, double truth, double width) {
  const VolumeBounds bounds = union_volume(spheres, width);
  EXPECT_LE(bounds.lower, truth);
  EXPECT_GE(bounds.upper, truth);
  EXPECT_LE(bounds.upper - bounds.lower, width * bounds.upper * (1.0 + 1e-6));
}

std::vector<Sphere> random_spheres(unsigned seed, int count) {
  Dice dice(seed);
  std::vector<Sphere> spheres;
  for (int i = 0; i < count; ++i) spheres.push_back({dice.point(0.5), dice.uniform(0.05, 0.3)});
  return spheres;
}

TEST(SphereUnion, TheVolumeOfOneSphereLiesBetweenTheBounds) {
  Dice dice(1);
  for (int trial = 0; trial < 20; ++trial) {
    const double r = dice.uniform(0.01, 2.0);
    expect_volume({{dice.point(3.0), r}}, sphere_volume(r), trial < 10 ? 1e-2 : 1e-3);
  }
}

TEST(SphereUnion, TheVolumeOfTwoSpheresIsTheirSumLessTheirLens) {
  Dice dice(2);
  for (int trial = 0; trial < 30; ++trial) {
    const double a = dice.uniform(0.1, 0.4), b = dice.uniform(0.1, 0.4);
    const double d = dice.uniform(std::abs(a - b) + 1e-3, a + b);
    const Eigen::Vector3d at = dice.point(1.0), towards = dice.point(1.0).normalized();
    expect_volume({{at, a}, {at + d * towards, b}},
                  sphere_volume(a) + sphere_volume(b) - lens_volume(a, b, d), 2e-3);
  }
}

TEST(SphereUnion, SpheresFarApartAddUpAndSpheresInsideOthersAddNothing) {
  const std::vector<Sphere> apart{{{0, 0, 0}, 0.2}, {{5, 1, 0}, 0.3}, {{-2, 7, 3}, 0.1}};
  const double sum = sphere_volume(0.2) + sphere_volume(0.3) + sphere_volume(0.1);
  expect_volume(apart, sum, 2e-3);
  EXPECT_NEAR(union_area(apart).area, 4 * pi * (0.04 + 0.09 + 0.01), 1e-9);
  std::vector<Sphere> nested = apart;
  nested.push_back({{0.05, 0, 0}, 0.1});
  nested.push_back(apart[1]);
  expect_volume(nested, sum, 2e-3);
  EXPECT_NEAR(union_area(nested).area, 4 * pi * (0.04 + 0.09 + 0.01), 1e-9);
}

TEST(SphereUnion, TheBoundsHoldTheVolumeCountedByRandomPoints) {
  for (unsigned seed = 0; seed < 4; ++seed) {
    const PaintedVolume volume{"v", {}, random_spheres(seed, 25), {}};
    const VolumeBounds bounds = union_volume(volume.spheres, 4e-3);
    Dice dice(100 + seed);
    constexpr int points = 400'000;
    int inside = 0;
    for (int i = 0; i < points; ++i) inside += volume.contains(dice.point(0.8)) ? 1 : 0;
    const double share = static_cast<double>(inside) / points;
    const double box = 1.6 * 1.6 * 1.6;
    const double sigma = box * std::sqrt(share * (1 - share) / points);
    EXPECT_NEAR(bounds.middle(), box * share, 4 * sigma + bounds.half_width());
    EXPECT_LE(bounds.upper - bounds.lower, 4.1e-3 * bounds.upper);
  }
}

TEST(SphereUnion, FewerCubesGiveWiderBoundsThatHoldTheNarrowOnes) {
  const auto spheres = random_spheres(9, 30);
  const VolumeBounds fine = union_volume(spheres, 2e-3);
  for (const std::size_t cells : {1U, 100U, 3000U, 30'000U}) {
    const VolumeBounds coarse = union_volume(spheres, 1e-6, cells);
    EXPECT_LE(coarse.lower, fine.lower * (1 + 1e-3));
    EXPECT_LE(coarse.lower, fine.upper);
    EXPECT_GE(coarse.upper, fine.lower);
  }
}

TEST(SphereUnion, TheAreaOfTwoSpheresIsThatOfTheFormula) {
  Dice dice(3);
  for (int trial = 0; trial < 50; ++trial) {
    const double a = dice.uniform(0.1, 0.4), b = dice.uniform(0.1, 0.4);
    const double d = dice.uniform(std::abs(a - b) + 1e-3, a + b);
    const Eigen::Vector3d at = dice.point(1.0), towards = dice.point(1.0).normalized();
    const double truth = open_area_of_two(a, b, d);
    EXPECT_NEAR(union_area({{at, a}, {at + d * towards, b}}).area, truth, 1e-3 * truth);
  }
}

TEST(SphereUnion, TheAreaIsTheRateAtWhichTheVolumeGrowsWithTheRadii) {
  for (unsigned seed = 20; seed < 22; ++seed) {
    auto spheres = random_spheres(seed, 8);
    const AreaEstimate area = union_area(spheres, 512);
    const VolumeBounds small = union_volume(spheres, 5e-4);
    constexpr double growth = 1e-2;
    for (Sphere& sphere : spheres) sphere.radius += growth;
    const AreaEstimate grown = union_area(spheres, 512);
    const VolumeBounds large = union_volume(spheres, 5e-4);
    const double rate = (large.middle() - small.middle()) / growth;
    const double doubt = (large.half_width() + small.half_width()) / growth;
    EXPECT_NEAR(0.5 * (area.area + grown.area), rate, doubt + 2e-3 * rate);
    EXPECT_LT(area.error, 5e-3 * area.area);
  }
}

TEST(SphereUnion, RefusesWhatIsNoSphere) {
  EXPECT_THROW(union_volume({{{0, 0, 0}, 0.0}}), std::invalid_argument);
  EXPECT_THROW(union_area({{{0, HUGE_VAL, 0}, 1.0}}), std::invalid_argument);
  EXPECT_THROW(union_volume({{{0, 0, 0}, 1.0}}, 0.0), std::invalid_argument);
  EXPECT_THROW(union_area({{{0, 0, 0}, 1.0}}, 1), std::invalid_argument);
  EXPECT_EQ(union_volume({}).upper, 0.0);
  EXPECT_EQ(union_area({}).area, 0.0);
}

}  // namespace sphere_union_test
}  // namespace clearway
