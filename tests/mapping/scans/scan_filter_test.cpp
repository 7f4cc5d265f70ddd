#include "mapping/scans/scan_filter.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <numeric>
#include <set>
#include <tuple>

#include "tests/worlds/random_map.hpp"

namespace clearway {
namespace scan_filter_test {

using worlds::Dice;
using worlds::random_scan;

TEST(ScanFilter, AnEmptyFilterKeepsAllPointsInTheMapFrame) {
  Dice dice(1);
  const Scan scan = random_scan(dice, 100);
  const FilteredPoints kept = filter_points(scan, {});
  ASSERT_EQ(kept.points.size(), 100U);
  for (std::size_t i = 0; i < 100; ++i) {
    const Eigen::Vector3d expected = scan.map_from_sensor * scan.points[i].cast<double>();
    EXPECT_EQ(kept.points[i], expected.cast<float>());
  }
  EXPECT_EQ(kept.origin, scan.map_from_sensor.translation());
}

TEST(ScanFilter, DropsExactlyWhatEachRuleNames) {
  Dice dice(2);
  const Scan scan = random_scan(dice, 2000);
  ScanFilter filter;
  filter.min_range = 0.6;
  filter.crop = {Eigen::Vector3d(-0.5, -0.6, -0.7), Eigen::Vector3d(0.5, 0.6, 0.7)};
  filter.bodies = {{{0.3, 0.3, -1.0}, {0.3, 0.3, 1.0}, 0.2}, {{-0.4, 0.0, 0.0}, {-0.4, 0.0, 0.0}, 0.3}};
  const FilteredPoints kept = filter_points(scan, filter);
  std::size_t expected = 0;
  for (const Eigen::Vector3f& point : scan.points) {
    const Eigen::Vector3d p = scan.map_from_sensor * point.cast<double>();
    const bool outside = std::abs(p.x()) > 0.5 || std::abs(p.y()) > 0.6 || std::abs(p.z()) > 0.7;
    const bool in_post = std::hypot(p.x() - 0.3, p.y() - 0.3) <= 0.2 && std::abs(p.z()) <= 1.0;
    const bool in_sphere = (p - Eigen::Vector3d(-0.4, 0.0, 0.0)).norm() <= 0.3;
    if (point.cast<double>().norm() >= 0.6 && !outside && !in_post && !in_sphere) ++expected;
  }
  EXPECT_EQ(kept.points.size(), expected);
  EXPECT_EQ(kept.dropped_filter, scan.points.size() - expected);
  EXPECT_GT(expected, 50U);
}

TEST(ScanFilter, ACapsuleHoldsWhatIsWithinItsRadiusOfItsSegment) {
  const Capsule capsule{{0, 0, 0}, {1, 0, 0}, 0.5};
  EXPECT_TRUE(contains(capsule, {0.5, 0.5, 0.0}));
  EXPECT_FALSE(contains(capsule, {0.5, 0.51, 0.0}));
  EXPECT_TRUE(contains(capsule, {1.5, 0.0, 0.0}));
  EXPECT_FALSE(contains(capsule, {1.4, 0.4, 0.0}));
  EXPECT_TRUE(contains({{1, 1, 1}, {1, 1, 1}, 0.0}, {1, 1, 1}));
}

TEST(ScanFilter, ThinningKeepsOnePointPerCube) {
  Dice dice(3);
  const Scan scan = random_scan(dice, 5000);
  const double edge = 0.2;
  std::set<std::tuple<int, int, int>> cubes;
  for (const Eigen::Vector3f& point : filter_points(scan, {}).points) {
    const Eigen::Array3i cube = (point.cast<double>().array() / edge).floor().cast<int>();
    cubes.insert({cube.x(), cube.y(), cube.z()});
  }
  const FilteredPoints all = filter_points(scan, {}), kept = filter_points(scan, {.thin_to = edge});
  EXPECT_EQ(kept.points.size(), cubes.size());
  EXPECT_EQ(kept.points.size() + kept.dropped_filter, scan.points.size());
  for (const Eigen::Vector3f& ray : kept.points) {
    const auto is_with_it = [&](const Eigen::Vector3f& point) {
      const auto cube = [&](const Eigen::Vector3f& of) -> Eigen::Array3d {
        return (of.cast<double>().array() / edge).floor();
      };
      return (cube(point) == cube(ray)).all();
    };
    Eigen::Vector3d sum = Eigen::Vector3d::Zero();
    double count = 0.0, nearest = HUGE_VAL;
    for (const Eigen::Vector3f& point : all.points)
      if (is_with_it(point)) sum += point.cast<double>(), ++count;
    for (const Eigen::Vector3f& point : all.points)
      if (is_with_it(point)) nearest = std::min(nearest, (point.cast<double>() - sum / count).norm());
    ASSERT_GT(count, 0.0);  // a point that was measured
    EXPECT_NEAR((ray.cast<double>() - sum / count).norm(), nearest, 1e-12);
  }
}

TEST(ScanFilter, AWideScanIsThinned) {
  Scan scan;
  scan.points = {{0, 0, 0}, {3e4F, 3e4F, 3e4F}, {-3e4F, 0, 0}, {3e4F, 3e4F, 3e4F}};
  EXPECT_EQ(filter_points(scan, {.thin_to = 1e-3}).points.size(), 3U);
}

TEST(ScanFilter, OutliersAreThoseWhoseNeighboursAreUnusuallyFar) {
  Dice dice(4);
  Scan scan;
  for (int i = 0; i < 300; ++i) {  // a wall with a few points in front of it
    const Eigen::Vector3f aside = dice.point(1.0).cast<float>();
    scan.points.emplace_back(i % 30 == 0 ? 1.0F : 2.0F, aside.y(), aside.z());
  }
  const int neighbours = 8;
  const double deviations = 1.5;
  std::vector<double> mean_distances;
  for (const Eigen::Vector3f& point : scan.points) {
    std::vector<double> distances;
    for (const Eigen::Vector3f& other : scan.points)
      distances.push_back((other - point).cast<double>().norm());
    std::sort(distances.begin(), distances.end());  // the first is the point itself
    mean_distances.push_back(std::accumulate(distances.begin() + 1, distances.begin() + 1 + neighbours, 0.0) /
                             neighbours);
  }
  const double count = static_cast<double>(scan.points.size());
  const double mean = std::accumulate(mean_distances.begin(), mean_distances.end(), 0.0) / count;
  double squares = 0.0;
  for (const double value : mean_distances) squares += (value - mean) * (value - mean);
  const double limit = mean + deviations * std::sqrt(squares / (count - 1.0));
  std::vector<Eigen::Vector3f> expected;
  for (std::size_t i = 0; i < scan.points.size(); ++i) {
    if (mean_distances[i] <= limit) expected.push_back(scan.points[i]);
  }
  ASSERT_LT(expected.size(), scan.points.size());
  ScanFilter filter;
  filter.outlier_neighbours = neighbours;
  filter.outlier_deviations = deviations;
  const FilteredPoints kept = filter_points(scan, filter);
  EXPECT_EQ(kept.points, expected);
  EXPECT_EQ(kept.points.size() + kept.dropped_filter, scan.points.size());
}

TEST(ScanFilter, RaysBeyondTheRangeAreNoOutliers) {
  Scan scan;
  for (int i = 0; i < 50; ++i) scan.points.emplace_back(1.0F, 0.01F * static_cast<float>(i), 0.0F);
  scan.points.emplace_back(0.0F, 0.0F, 9.0F);   // far from the others
  scan.points.emplace_back(0.0F, 0.0F, -1.5F);  // and so is this, a hit
  ScanFilter filter;
  filter.max_range = 2.0;
  filter.outlier_neighbours = 5;
  const FilteredPoints kept = filter_points(scan, filter);
  EXPECT_EQ(kept.points.size(), 51U);
  EXPECT_EQ(kept.points.back(), Eigen::Vector3f(0.0F, 0.0F, 9.0F));
}

TEST(ScanFilter, NamesTheFieldThatMakesNoSense) {
  const auto refusal = [](const ScanFilter& filter) -> std::string {
    try {
      filter_points({}, filter);
    } catch (const std::invalid_argument& error) {
      return error.what();
    }
    return "";
  };
  const auto refused = [&](const std::string& word, const auto& spoil) {
    ScanFilter filter;
    spoil(filter);
    EXPECT_NE(refusal(filter).find(word), std::string::npos) << word;
  };
  refused("min_range", [](ScanFilter& filter) { filter.min_range = -1.0; });
  refused("max_range", [](ScanFilter& filter) { filter.max_range = std::nan(""); });
  refused("outlier_neighbours", [](ScanFilter& filter) { filter.outlier_neighbours = -1; });
  refused("outlier_deviations", [](ScanFilter& filter) { filter.outlier_deviations = -1.0; });
  refused("thin_to", [](ScanFilter& filter) { filter.thin_to = HUGE_VAL; });
  refused("radius", [](ScanFilter& filter) { filter.bodies = {{{0, 0, 0}, {0, 0, 1}, -0.1}}; });
  refused("crop", [](ScanFilter& filter) {
    filter.crop = {Eigen::Vector3d(0, std::nan(""), 0), Eigen::Vector3d(1, 1, 1)};
  });
  refused("axis", [](ScanFilter& filter) { filter.bodies = {{{0, std::nan(""), 0}, {0, 0, 1}, 0.1}}; });
}

/// Of no more points than neighbours are asked for nobody knows which stand apart.
TEST(ScanFilter, FewerPointsThanNeighboursAreNoOutliers) {
  Scan scan;
  scan.points = {
      {1.0F, 0.0F, 0.0F}, {1.0F, 0.01F, 0.0F}, {1.0F, 0.0F, 0.01F}, {1.0F, 0.01F, 0.01F}, {3.0F, 2.0F, 0.0F}};
  for (const int neighbours : {2, 4, 5, 8}) {
    const FilteredPoints kept =
        filter_points(scan, {.outlier_neighbours = neighbours, .outlier_deviations = 0.5});
    EXPECT_EQ(kept.points.size(), neighbours < 5 ? 4U : 5U) << neighbours;
  }
}

}  // namespace scan_filter_test
}  // namespace clearway
