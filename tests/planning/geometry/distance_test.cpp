#include <gtest/gtest.h>

#include "planning/geometry/segment_distance.hpp"
#include "planning/geometry/shape.hpp"
#include "planning/geometry/sweep_beyond.hpp"
#include "tests/worlds/fcl_truth.hpp"
#include "tests/worlds/random_world.hpp"

namespace clearway {
namespace distance_test {

/// A body; sizes on a 5 cm grid or thin now and then, which is where distance codes fail.
Shape random_shape(Random& random, bool on_grid) {
  const auto size = [&](double low, double high) {
    const double value = random.between(low, high);
    return on_grid ? std::ceil(value / 0.05) * 0.05 : (random.below(8) == 0 ? value / 100 : value);
  };
  switch (random.below(4)) {
    case 0:
      return Shape::sphere(size(0.02, 0.3));
    case 1:
      return Shape::capsule(size(0.02, 0.2), size(0.05, 0.6));
    case 2:
      return Shape::cylinder(size(0.02, 0.2), size(0.05, 0.6));
    default:
      return Shape::box({size(0.02, 0.5), size(0.02, 0.5), size(0.02, 0.5)});
  }
}

Eigen::Isometry3d random_pose(Random& random, bool on_grid) {
  Eigen::Isometry3d pose = random.pose(0.6);
  if (!on_grid) return pose;
  const std::array<double, 4> quarter{0.0, std::numbers::pi / 2, std::numbers::pi, -std::numbers::pi / 2};
  pose.linear() = Eigen::AngleAxisd(quarter[static_cast<std::size_t>(random.below(4))],
                                    Eigen::Vector3d::Unit(random.below(3)))
                      .toRotationMatrix();
  for (int i = 0; i < 3; ++i) pose.translation()[i] = std::round(pose.translation()[i] / 0.05) * 0.05;
  return pose;
}

struct Tally {
  int pairs = 0, separate = 0, open = 0;
  double worst_lower = 0.0, worst_upper = 0.0, worst_gap = 0.0;
};

/// Compares one pair with FCL. FCL's own tolerance is allowed for: 1e-6 m.
void compare(const Shape& a, const Eigen::Isometry3d& pose_a, const Shape& b, const Eigen::Isometry3d& pose_b,
             Tally& tally) {
  const DistanceBounds bounds = distance(a, pose_a, b, pose_b);
  ++tally.pairs;
  ASSERT_LE(bounds.lower, bounds.upper);
  // The certificate, checked here in its own terms: no point of a is beyond, none of b before the plane.
  if (bounds.lower > 0.0) {
    ++tally.separate;
    const double far_a =
        bounds.direction.dot(pose_a * a.support(pose_a.linear().transpose() * bounds.direction));
    const double near_b =
        bounds.direction.dot(pose_b * b.support(-(pose_b.linear().transpose() * bounds.direction)));
    ASSERT_GE(near_b - far_a, bounds.lower - 1e-5);
    ASSERT_LT(a.signed_distance(pose_a.inverse() * bounds.point_a), 1e-6);
    ASSERT_LT(b.signed_distance(pose_b.inverse() * bounds.point_b), 1e-6);
    ASSERT_NEAR((bounds.point_b - bounds.point_a).norm(), bounds.upper, 1e-9);
  }
  const auto geometry_a = fcl_geometry(a), geometry_b = fcl_geometry(b);
  const bool touch = fcl_collide(geometry_a.get(), pose_a, geometry_b.get(), pose_b);
  const double expected = touch ? 0.0 : fcl_distance(geometry_a.get(), pose_a, geometry_b.get(), pose_b);
  tally.worst_lower = std::max(tally.worst_lower, bounds.lower - expected);
  if (bounds.upper < 0.01 || expected > 0.0)
    tally.worst_upper = std::max(tally.worst_upper, expected - bounds.upper);
  const double size = a.bounding_radius() + b.bounding_radius();
  if (a.is_rounded() && b.is_rounded()) {  // no iteration
    ASSERT_LE(bounds.upper - bounds.lower,
              1e-12 * (size + (pose_a.translation() - pose_b.translation()).norm()));
  }
  tally.worst_gap = std::max(tally.worst_gap, (bounds.upper - bounds.lower) / size);
  if (bounds.upper - bounds.lower > 1e-6 * size) ++tally.open;
}

TEST(Distance, BoundsHoldTheDistanceOfFclForRandomPairs) {
  Random random(1);
  Tally tally;
  for (int i = 0; i < 60'000; ++i) {
    const Shape a = random_shape(random, false), b = random_shape(random, false);
    compare(a, random_pose(random, false), b, random_pose(random, false), tally);
    if (HasFatalFailure()) return;
  }
  EXPECT_GT(tally.separate, 20'000);
  EXPECT_LT(tally.worst_lower, 1e-5);
  EXPECT_LT(tally.worst_upper, 1e-5);
  EXPECT_EQ(tally.open, 0) << "worst gap " << tally.worst_gap;
}

TEST(Distance, BoundsHoldTheDistanceOfFclForAlignedTouchingAndGridPairs) {
  Random random(2);
  Tally tally;
  for (int i = 0; i < 60'000; ++i) {
    const Shape a = random_shape(random, true), b = random_shape(random, true);
    compare(a, random_pose(random, true), b, random_pose(random, true), tally);
    if (HasFatalFailure()) return;
  }
  EXPECT_LT(tally.worst_lower, 1e-5);
  EXPECT_LT(tally.worst_upper, 1e-5);
  EXPECT_EQ(tally.open, 0) << "worst gap " << tally.worst_gap;
}

TEST(Distance, OfBodiesInMillimetresIsTheSameNumberAsOfBodiesInMetres) {
  Random random(3);
  int near = 0;
  for (int i = 0; i < 4'000; ++i) {
    const Shape a = random_shape(random, false), b = random_shape(random, false);
    const Eigen::Isometry3d pose_a = random_pose(random, false);
    Eigen::Isometry3d pose_b = random_pose(random, false);
    if (i % 2 == 0) {  // a hair apart
      const DistanceBounds gap = distance(a, pose_a, b, pose_b);
      if (gap.lower > 0.0) pose_b.translation() -= (1.0 - 1e-9) * gap.lower * gap.direction;
    }
    const DistanceBounds bounds = distance(a, pose_a, b, pose_b);
    near += bounds.lower > 0.0 && bounds.lower < 1e-8 ? 1 : 0;
    for (const double factor : {0x1p-20, 0x1p-10, 0x1p10, 0x1p20}) {  // scale without any rounding
      const auto scaled_pose = [&](Eigen::Isometry3d pose) {
        pose.translation() *= factor;
        return pose;
      };
      const DistanceBounds scaled =
          distance(a.scaled(factor), scaled_pose(pose_a), b.scaled(factor), scaled_pose(pose_b));
      ASSERT_EQ(scaled.lower / factor, bounds.lower) << i << " times " << factor;
      ASSERT_EQ(scaled.upper / factor, bounds.upper) << i << " times " << factor;
    }
  }
  EXPECT_GT(near, 300);
}

TEST(Distance, ToACubeEqualsDistanceToABoxOfTheSameSize) {
  Random random(3);
  double worst = 0.0;
  for (int i = 0; i < 40'000; ++i) {
    const bool on_grid = i % 2 == 0;
    const Shape a = random_shape(random, on_grid);
    const Eigen::Isometry3d pose = random_pose(random, on_grid);
    const Eigen::Vector3d center = random.point(0.6);
    const DistanceBounds cube = distance_to_cube(a, pose, center, 0.05);
    const double expected =
        distance(a, pose, Shape::box({0.05, 0.05, 0.05}), Eigen::Isometry3d(Eigen::Translation3d{center}))
            .upper;
    worst = std::max({worst, std::abs(cube.upper - expected), std::abs(cube.lower - expected)});
  }
  EXPECT_LT(worst, 1e-6);
}

/// Distance between capsules from a fine grid over both segments, refined twice: slow and obvious.
double sampled_distance(const Eigen::Vector3d& a0, const Eigen::Vector3d& a1, const Eigen::Vector3d& b0,
                        const Eigen::Vector3d& b1) {
  double s_low = 0, s_high = 1, t_low = 0, t_high = 1, best = 1e300;
  for (int round = 0; round < 8; ++round) {
    double best_s = 0, best_t = 0;
    best = 1e300;
    for (int i = 0; i <= 20; ++i) {
      for (int k = 0; k <= 20; ++k) {
        const double s = s_low + (s_high - s_low) * i / 20, t = t_low + (t_high - t_low) * k / 20;
        const double d = (a0 + s * (a1 - a0) - b0 - t * (b1 - b0)).norm();
        if (d < best) best = d, best_s = s, best_t = t;
      }
    }
    const double ds = (s_high - s_low) / 8, dt = (t_high - t_low) / 8;
    s_low = std::max(0.0, best_s - ds), s_high = std::min(1.0, best_s + ds);
    t_low = std::max(0.0, best_t - dt), t_high = std::min(1.0, best_t + dt);
  }
  return best;
}

TEST(SegmentDistance, AgreesWithSearchByGrid) {
  Random random(4);
  for (int i = 0; i < 1'000; ++i) {
    const Eigen::Vector3d a0 = random.point(1), a1 = random.point(1), b0 = random.point(1);
    Eigen::Vector3d b1 = random.point(1);
    if (i % 10 == 0) b1 = b0 + (a1 - a0);  // parallel
    if (i % 10 == 1) b1 = b0;              // a point
    const NearestPair pair = segment_to_segment(a0, a1, b0, b1);
    EXPECT_NEAR(pair.distance, sampled_distance(a0, a1, b0, b1), 2e-5);
  }
}

TEST(SegmentDistance, ToABoxIsNeverBeatenByAnySampledPoint) {
  Random random(5);
  for (int i = 0; i < 2'000; ++i) {
    const Eigen::Vector3d half(random.between(0.05, 0.5), random.between(0.05, 0.5),
                               random.between(0.05, 0.5));
    const Eigen::Vector3d a0 = random.point(1), a1 = i % 10 == 0 ? a0 : random.point(1);
    const NearestPair pair = segment_to_box(a0, a1, half);
    for (int k = 0; k <= 200; ++k) {
      const Eigen::Vector3d p = a0 + k / 200.0 * (a1 - a0);
      ASSERT_GE((p - p.cwiseMax(-half).cwiseMin(half)).norm(), pair.distance - 1e-12);
    }
  }
}

TEST(Distance, OfAConvexHullIsThatOfTheBoxWithTheSameCorners) {
  Random random(6);
  for (int i = 0; i < 2'000; ++i) {
    const Eigen::Vector3d edges(random.between(0.05, 0.5), random.between(0.05, 0.5),
                                random.between(0.05, 0.5));
    std::vector<Eigen::Vector3d> points;
    for (int k = 0; k < 8; ++k)
      points.emplace_back(
          Eigen::Vector3d((k & 1) - 0.5, (k >> 1 & 1) - 0.5, (k >> 2) - 0.5).cwiseProduct(edges));
    for (int k = 0; k < 20; ++k) points.emplace_back(random.point(0.5).cwiseProduct(edges));  // inside
    const Shape hull = Shape::convex(points), box = Shape::box(edges), other = random_shape(random, false);
    const Eigen::Isometry3d pose_a = random.pose(0.5), pose_b = random.pose(0.5);
    const DistanceBounds a = distance(hull, pose_a, other, pose_b), b = distance(box, pose_a, other, pose_b);
    EXPECT_NEAR(a.lower, b.lower, 1e-6);
    EXPECT_NEAR(a.upper, b.upper, 1e-6);
  }
}

TEST(Distance, OfASweptBodyIsThatOfTheHullOfItsCornersAtBothPoses) {
  Random random(9);
  int apart = 0;
  for (int i = 0; i < 2000; ++i) {
    const Eigen::Vector3d edges(random.between(0.02, 0.4), random.between(0.02, 0.4),
                                random.between(0.02, 0.4));
    const Shape box = Shape::box(edges);
    const Eigen::Isometry3d begin = random.pose(0.5), end = random.pose(0.5);
    std::vector<Eigen::Vector3d> corners;
    for (int corner = 0; corner < 8; ++corner) {
      const Eigen::Vector3d sign(corner & 1 ? 1 : -1, corner & 2 ? 1 : -1, corner & 4 ? 1 : -1);
      const Eigen::Vector3d at = edges.cwiseProduct(sign) / 2;
      corners.push_back(begin * at);
      corners.push_back(end * at);
    }
    const Eigen::Vector3d cube = random.point(0.5);
    const DistanceBounds hull =
        distance_to_cube(Shape::convex(corners), Eigen::Isometry3d::Identity(), cube, 0.05);
    const DistanceBounds swept = swept_distance_to_cube(box, begin, end, cube, 0.05);
    ASSERT_NEAR(swept.lower, hull.lower, 1e-6) << i;
    ASSERT_LE(swept.lower, hull.upper + 1e-12) << i;
    apart += swept.lower > 0.0;
  }
  EXPECT_GT(apart, 500);
  EXPECT_LT(apart, 1900);
}

TEST(Distance, WhetherASweepIsBeyondAMarginFollowsFromItsDistance) {
  Random random(11);
  int beyond = 0;
  for (int i = 0; i < 4000; ++i) {
    const Shape shape = random_shape(random, false);
    const Eigen::Isometry3d begin = random.pose(0.5), end = random.pose(0.5);
    const Eigen::Vector3d cube = random.point(0.8);
    const double lower = swept_distance_to_cube(shape, begin, end, cube, 0.05).lower;
    const double margin = i % 2 == 0 ? random.between(0.0, 0.3) : lower * random.between(0.99, 1.01);
    const Eigen::Vector3d towards = i % 4 < 2 ? cube - begin.translation() : random.point(1.0);
    ASSERT_TRUE(lower > 0.0 || !is_sweep_beyond(shape, begin, end, cube, 0.05, towards, 0.0)) << i;
    if (std::abs(lower - margin) < 1e-8) continue;  // a proof may stop a hair short
    ASSERT_EQ(is_sweep_beyond(shape, begin, end, cube, 0.05, towards, margin), lower > margin) << i;
    beyond += lower > margin;
  }
  EXPECT_GT(beyond, 500);
  EXPECT_LT(beyond, 3500);
}

TEST(Distance, OfASweptBodyIsNeverAboveThatOfAnyMixOfItsPoints) {
  Random random(10);
  for (int i = 0; i < 2000; ++i) {
    const Shape shape = random_shape(random, false);
    const Eigen::Isometry3d begin = random.pose(0.5), end = random.pose(0.5);
    const Eigen::Vector3d cube = random.point(0.8);
    const double lower = swept_distance_to_cube(shape, begin, end, cube, 0.05).lower;
    for (int k = 0; k < 50; ++k) {
      const Eigen::Vector3d a = begin * shape.support(random.point(1.0)),
                            b = end * shape.support(random.point(1.0));
      const Eigen::Vector3d mix = a + random.between(0.0, 1.0) * (b - a);
      const double gap = ((mix - cube).cwiseAbs().array() - 0.025).max(0.0).matrix().norm();
      ASSERT_LE(lower, gap + 1e-12) << i;
    }
  }
}

/// Bodies one behind the other along an axis, with faces square to it: their distance is a difference of
/// numbers, taken here with more digits. What is kept back for rounding grows with the coordinates.
TEST(Distance, LowerBoundsAreNeverAboveTheExactOnesAndNearlyThemWhateverTheSizes) {
  Random random(12);
  const auto drawn = [&](double low, double high) {
    return std::exp(random.between(std::log(low), std::log(high)));
  };
  struct Solid {
    Shape shape;
    double half;  ///< along x
  };
  const auto solid = [&] {
    const double half = drawn(1e-3, 1e3);
    const int kind = random.below(3);
    return Solid{kind == 0   ? Shape::sphere(half)
                 : kind == 1 ? Shape::box({2.0 * half, drawn(1e-2, 10.0), drawn(1e-2, 10.0)})
                             : Shape::capsule(half, drawn(1e-2, 10.0)),
                 half};
  };
  for (int i = 0; i < 20'000; ++i) {
    const Solid a = solid(), b = solid();
    const double gap = drawn(1e-6, 10.0), at = random.between(-1.0, 1.0) * drawn(1e-3, 1e3),
                 side = random.below(2) == 0 ? 1.0 : -1.0;
    const Eigen::Vector3d beside(0.0, random.between(-1.0, 1.0), random.between(-1.0, 1.0));
    const auto placed = [&](double x) {
      return Eigen::Isometry3d(Eigen::Translation3d(beside + x * Eigen::Vector3d::UnitX()));
    };
    const double other = at + side * (a.half + gap + b.half), farther = other + side * drawn(1e-6, 10.0);
    const auto expect = [&](const DistanceBounds& bounds, double half, double from, double to,
                            const char* what, double closely = 1e-7) {
      const long double exact = std::abs(static_cast<long double>(to) - from) - a.half - half;
      if (exact <= 0.0L) return;
      const double size = a.half + half + gap + std::abs(at) + 100.0;
      ASSERT_LE(static_cast<long double>(bounds.lower), exact) << what << " " << i;
      ASSERT_GE(static_cast<long double>(bounds.lower), exact - closely * size) << what << " " << i;
      ASSERT_NEAR(bounds.upper, static_cast<double>(exact), closely * size) << what << " " << i;
    };
    expect(distance(a.shape, placed(at), b.shape, placed(other)), b.half, at, other, "bodies");
    const Eigen::Vector3d cube = placed(other).translation();
    expect(distance_to_cube(a.shape, placed(at), cube, 2.0 * b.half), b.half, at, other, "cube");
    expect(swept_distance_to_cube(a.shape, placed(at - side * (farther - other)), placed(at), cube,
                                  2.0 * b.half),
           b.half, at, other, "sweep", 1.0);
    if (HasFatalFailure()) return;
  }
}

/// `enough` ends a search sooner: then the bound is above it, and still below the distance.
TEST(Distance, WithEnoughAskedForIsProvedAsFarAsThatOrIsTheDistanceItself) {
  Random random(13);
  std::array<int, 2> sides{};
  for (int i = 0; i < 6'000; ++i) {
    const Shape a = random_shape(random, i % 3 == 0), b = random_shape(random, i % 3 == 0);
    const Eigen::Isometry3d begin = random_pose(random, i % 3 == 0), end = random_pose(random, false);
    const Eigen::Vector3d cube = random.point(0.8);
    const auto compare_with = [&](const auto& bounds_of) {
      const DistanceBounds whole = bounds_of(std::numeric_limits<double>::infinity());
      const double enough = i % 4 == 0   ? random.between(0.0, 0.5)
                            : i % 4 == 1 ? 0.0
                                         : whole.lower * random.between(0.9, 1.1);
      if (std::abs(whole.lower - enough) < 1e-7) return;
      const DistanceBounds some = bounds_of(enough);
      ASSERT_LE(some.lower, whole.upper + 1e-12) << i;
      ASSERT_GE(some.upper, whole.lower - 1e-12) << i;
      ASSERT_EQ(some.lower > enough, whole.lower > enough) << i;
      ++sides[whole.lower > enough ? 1 : 0];
      if (whole.lower > enough) return;
      ASSERT_NEAR(some.lower, whole.lower, 1e-7) << i;
      ASSERT_NEAR(some.upper, whole.upper, 1e-7) << i;
    };
    compare_with([&](double enough) { return distance(a, begin, b, end, enough); });
    compare_with([&](double enough) { return distance_to_cube(a, begin, cube, 0.05, enough); });
    compare_with([&](double enough) { return swept_distance_to_cube(a, begin, end, cube, 0.05, enough); });
    if (HasFatalFailure()) return;
  }
  EXPECT_GT(sides[0], 3'000);
  EXPECT_GT(sides[1], 3'000);
}

/// Where faces are parallel the search may begin at directions that separate by less than rounding takes off
/// the proof: it goes on.
TEST(Distance, OfBoxesOnAGridProvesThoseApartThatAreAndNoOthers) {
  Random random(31);
  constexpr double edge = 0.05;
  std::array<int, 2> sides{};
  const auto steps = [&](double most) { return std::floor(random.between(-most, most)); };
  for (int i = 0; i < 20'000; ++i) {
    const Eigen::Vector3d sizes =
        edge * Eigen::Vector3d(2.0 + steps(2), 2.0 + steps(2), 2.0 + steps(2)).cwiseMax(1.0);
    const Eigen::Vector3d at = 0.5 * edge * Eigen::Vector3d(steps(8), steps(8), steps(8));
    const Eigen::Vector3d cube = 0.5 * edge * Eigen::Vector3d(steps(8), steps(8), steps(8));
    const Eigen::Vector3d gap =
        ((at - cube).cwiseAbs() - 0.5 * sizes - Eigen::Vector3d::Constant(0.5 * edge)).cwiseMax(0.0);
    const double away = gap.norm();
    const Eigen::Isometry3d pose(Eigen::Translation3d{at});
    const double proved = distance_to_cube(Shape::box(sizes), pose, cube, edge, 0.0).lower;
    const double swept = swept_distance_to_cube(Shape::box(sizes), pose, pose, cube, edge, 0.0).lower;
    ASSERT_EQ(proved > 0.0, away > 0.2 * edge) << i << ": " << at.transpose() << ", " << cube.transpose();
    ASSERT_EQ(swept > 0.0, away > 0.2 * edge) << i;
    ASSERT_LE(proved, away + 1e-12);
    ++sides[away > 0.2 * edge ? 1 : 0];
  }
  EXPECT_GT(sides[0], 500);
  EXPECT_GT(sides[1], 1'000);
}

bool is_nothing(const DistanceBounds& bounds) {
  return bounds.lower == 0.0 && bounds.upper == 0.0 && bounds.point_a.isZero(0.0) &&
         bounds.point_b.isZero(0.0) && bounds.direction.isZero(0.0);
}

TEST(Distance, IsNotProvedForPosesThatAreNotFinite) {
  const std::array shapes{Shape::capsule(0.1, 0.5), Shape::box({0.1, 0.2, 0.3}), Shape::sphere(0.1)};
  const Eigen::Isometry3d good(Eigen::Translation3d(3.0, 1.0, 0.5));
  const Eigen::Vector3d cube = Eigen::Vector3d::Constant(-4.0);
  for (const Shape& shape : shapes) {
    EXPECT_GT(distance(shape, good, shape, Eigen::Isometry3d::Identity()).lower, 1.0);
    EXPECT_GT(distance_to_cube(shape, good, cube, 0.1).lower, 1.0);
    EXPECT_TRUE(is_sweep_beyond(shape, good, good, cube, 0.1, cube, 0.1));
    for (const double value : {std::nan(""), HUGE_VAL, -HUGE_VAL}) {
      for (int entry = 0; entry < 12; ++entry) {
        Eigen::Isometry3d bad = good;
        bad.matrix()(entry % 3, entry / 3) = value;
        for (const Shape& other : shapes) {
          EXPECT_TRUE(is_nothing(distance(shape, bad, other, Eigen::Isometry3d::Identity()))) << entry;
          EXPECT_TRUE(is_nothing(distance(other, Eigen::Isometry3d::Identity(), shape, bad))) << entry;
        }
        EXPECT_TRUE(is_nothing(distance_to_cube(shape, bad, cube, 0.1))) << entry;
        for (const auto& [begin, end] : {std::pair(bad, good), std::pair(good, bad)}) {
          EXPECT_TRUE(is_nothing(swept_distance_to_cube(shape, begin, end, cube, 0.1))) << entry;
          EXPECT_FALSE(is_sweep_beyond(shape, begin, end, cube, 0.1, cube - good.translation(), 0.1))
              << entry;
        }
      }
      Eigen::Vector3d lost = cube;
      lost.y() = value;
      EXPECT_TRUE(is_nothing(distance_to_cube(shape, good, lost, 0.1)));
      EXPECT_TRUE(is_nothing(swept_distance_to_cube(shape, good, good, lost, 0.1)));
    }
  }
}

}  // namespace distance_test
}  // namespace clearway
