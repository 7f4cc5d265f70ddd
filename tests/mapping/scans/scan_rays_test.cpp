// Scan integration against stock OctoMap on the same points.

#include "mapping/scans/scan_rays.hpp"
#include "mapping/scans/scan_filter.hpp"

#include <gtest/gtest.h>
#include <octomap/ScanGraph.h>

#include <cstdlib>
#include <filesystem>

#include "mapping/free_space_map.hpp"
#include "tests/worlds/random_map.hpp"
#include "tests/worlds/stock_octomap.hpp"

namespace clearway {
namespace scan_rays_test {

using worlds::Dice;
using worlds::expect_equal;
using worlds::insert_stock;
using worlds::random_scan;
constexpr Integration compatible = Integration::compatible;

TEST(ScanRays, WithoutPaintTheTreeIsStockOctoMaps) {
  for (const bool discretize : {false, true}) {
    for (const double max_range : {0.0, 0.7}) {
      for (unsigned seed = 0; seed < 4; ++seed) {
        Dice dice(seed);
        const double resolution = dice.uniform(0.03, 0.1);
        octomap::OcTree stock(resolution);
        FreeSpaceMap map({.resolution = resolution, .discretize = discretize, .integration = compatible});
        for (int i = 0; i < 4; ++i) {
          const Scan scan = random_scan(dice, 400);
          insert_stock(stock, scan, max_range, discretize);
          map.insert(scan, {.max_range = max_range});
        }
        expect_equal(stock, map.snapshot().tree());
      }
    }
  }
}

TEST(ScanRays, RepeatedScansReachClampingAsStockOctoMapDoes) {
  Dice dice(9);
  const Scan scan = random_scan(dice, 300);
  octomap::OcTree stock(0.05);
  FreeSpaceMap map({.resolution = 0.05, .integration = compatible});
  for (int i = 0; i < 25; ++i) {
    insert_stock(stock, scan, 0.0, false);
    map.insert(scan);
  }
  expect_equal(stock, map.snapshot().tree());
}

TEST(ScanRays, ForeignSensorModelsAreStockOctoMapsToo) {
  Dice dice(10);
  octomap::OcTree stock(0.05);
  stock.setProbHit(0.9);
  stock.setProbMiss(0.3);
  stock.setClampingThresMin(0.02);
  stock.setClampingThresMax(0.99);
  FreeSpaceMap map({.resolution = 0.05,
                    .hit_probability = 0.9,
                    .miss_probability = 0.3,
                    .min_probability = 0.02,
                    .max_probability = 0.99,
                    .integration = compatible});
  for (int i = 0; i < 8; ++i) {
    const Scan scan = random_scan(dice, 200);
    insert_stock(stock, scan, 0.0, false);
    map.insert(scan);
  }
  expect_equal(stock, map.snapshot().tree());
}

TEST(ScanRays, ARayFreesWhatItPassesAndFillsWhereItEnds) {
  FreeSpaceMap map({.resolution = 0.1, .integration = compatible});
  Scan scan;
  scan.map_from_sensor.translation() = Eigen::Vector3d(0.05, 0.05, 0.05);
  scan.points = {{1.0F, 0.0F, 0.0F}};
  EXPECT_EQ(map.insert(scan).inserted, 1U);
  const Snapshot snapshot = map.snapshot();
  for (int i = 0; i < 10; ++i) EXPECT_EQ(snapshot.state({0.1 * i + 0.05, 0.05, 0.05}), VoxelState::seen_free);
  EXPECT_EQ(snapshot.state({1.05, 0.05, 0.05}), VoxelState::occupied);
  EXPECT_EQ(snapshot.state({1.15, 0.05, 0.05}), VoxelState::unknown);
  EXPECT_EQ(snapshot.counts().seen_free, 10U);
}

TEST(ScanRays, WithinOneScanOccupiedBeatsFree) {
  FreeSpaceMap map({.resolution = 0.1, .integration = compatible});
  Scan scan;
  scan.points = {{0.55F, 0.02F, 0.02F}, {1.55F, 0.05F, 0.05F}, {1.55F, 0.06F, 0.05F}, {1.55F, 0.05F, 0.06F}};
  map.insert(scan);
  EXPECT_EQ(map.snapshot().state({0.55, 0.05, 0.05}), VoxelState::occupied);
}

TEST(ScanRays, BeyondMaxRangeARayOnlyFrees) {
  FreeSpaceMap map({.resolution = 0.01, .integration = compatible});
  Scan scan;
  scan.map_from_sensor.translation() = Eigen::Vector3d::Constant(0.005);
  scan.points = {{400.0F, 0.0F, 0.0F}};  // outside the key range of 1 cm: stock code makes it an obstacle
  const ScanCounts counts = map.insert(scan, {.max_range = 1.0});
  EXPECT_EQ(counts.beyond_range, 1U);
  const VoxelCounts voxels = map.snapshot().counts();
  EXPECT_EQ(voxels.occupied, 0U);
  EXPECT_EQ(voxels.seen_free, 100U);
}

TEST(ScanRays, DropsAndCountsPointsThatHaveNoVoxel) {
  for (const bool discretize : {false, true}) {
    FreeSpaceMap map({.resolution = 0.01, .discretize = discretize, .integration = compatible});
    const float nan = std::nanf(""), inf = HUGE_VALF;
    Scan scan;
    scan.points = {{nan, 0, 0},  {0, inf, 0},   {0, 0, -inf}, {400, 0, 0},
                   {0, -400, 0}, {3e38F, 0, 0}, {0.5F, 0, 0}};
    const ScanCounts counts = map.insert(scan);
    EXPECT_EQ(counts.dropped_invalid, 6U);
    EXPECT_EQ(counts.inserted, 1U);
    EXPECT_EQ(map.snapshot().counts().occupied, 1U);
    EXPECT_EQ(map.snapshot().state({0.505, 0.005, 0.005}), VoxelState::occupied);
  }
}

TEST(ScanRays, InsertsNothingFromAnOriginThatHasNoVoxel) {
  for (const double bad : {std::nan(""), HUGE_VAL, 400.0, -1e200}) {
    FreeSpaceMap map({.resolution = 0.01, .integration = compatible});
    Scan scan;
    scan.map_from_sensor.translation().y() = bad;
    scan.points = {{0.5F, 0, 0}, {0, 0.5F, 0}};
    const ScanCounts counts = map.insert(scan);
    EXPECT_TRUE(counts.origin_invalid);
    EXPECT_EQ(counts.inserted, 0U);
    EXPECT_EQ(counts.dropped_invalid, 2U);
    EXPECT_TRUE(map.snapshot().bounds().isEmpty());
  }
}

TEST(ScanRays, ARayMayBeLongerThanOctoMapsBuffer) {
  FreeSpaceMap map(
      {.resolution = 0.001, .integration = compatible});  // the diagonal of the key range is 196,605 steps
  Scan scan;
  scan.map_from_sensor.translation().setConstant(-32.0);
  scan.points = {{64.0F, 64.0F, 64.0F}, {0.01F, 0.0F, 0.0F}};
  const ScanCounts counts = map.insert(scan);
  EXPECT_EQ(counts.inserted, 2U);
  EXPECT_EQ(counts.dropped_invalid, 0U);
  const VoxelCounts voxels = map.snapshot().counts();
  EXPECT_EQ(voxels.occupied, 2U);
  EXPECT_NEAR(static_cast<double>(voxels.seen_free), 3 * 64000 + 9, 3);
}

TEST(ScanRays, EveryPointIsCountedOnce) {
  for (unsigned seed = 0; seed < 20; ++seed) {
    Dice dice(seed);
    FreeSpaceMap map({.resolution = 0.05, .discretize = seed % 2 == 0, .integration = compatible});
    Scan scan = random_scan(dice, 500);
    for (int i = 0; i < 20; ++i) scan.points.push_back({std::nanf(""), 0.0F, 0.0F});
    ScanFilter filter;
    filter.min_range = 0.55;
    filter.max_range = 0.8;
    filter.thin_to = seed % 3 == 0 ? 0.1 : 0.0;
    filter.crop = {Eigen::Vector3d::Constant(-0.9), Eigen::Vector3d::Constant(0.7)};
    filter.bodies = {{{0, 0, 0}, {0, 0, 1}, 0.2}};
    const ScanCounts counts = map.insert(scan, filter);
    EXPECT_EQ(counts.inserted + counts.beyond_range + counts.dropped_filter + counts.dropped_invalid, 520U);
    EXPECT_GE(counts.dropped_invalid, 20U);
    EXPECT_GT(counts.beyond_range, 0U);
    EXPECT_GT(counts.inserted, 0U);
  }
}

TEST(ScanRays, ARealSphericalScanGivesStockOctoMapsTree) {
  const char* folder = std::getenv("CLEARWAY_DATA");
  const std::filesystem::path data(folder != nullptr ? folder : CLEARWAY_SOURCE_DIR "/../shared/data");
  const std::filesystem::path file = data / "octomap_share/spherical_scan.graph";
  if (!std::filesystem::exists(file)) GTEST_SKIP() << file << " is not on this machine";
  octomap::ScanGraph graph;
  ::testing::internal::CaptureStderr();
  ASSERT_TRUE(graph.readBinary(file.string()));
  ::testing::internal::GetCapturedStderr();
  octomap::OcTree stock(0.1);
  FreeSpaceMap map({.resolution = 0.1, .integration = compatible});
  for (const octomap::ScanNode* node : graph) {
    Scan scan;
    scan.map_from_sensor.translation() = Eigen::Vector3d(node->pose.x(), node->pose.y(), node->pose.z());
    const auto& turn = node->pose.rot();
    scan.map_from_sensor.rotate(Eigen::Quaterniond(turn.u(), turn.x(), turn.y(), turn.z()).normalized());
    for (const octomap::point3d& point : *node->scan)
      scan.points.push_back({point.x(), point.y(), point.z()});
    EXPECT_GT(scan.points.size(), 1000U);
    insert_stock(stock, scan, 0.0, false);
    EXPECT_EQ(map.insert(scan).inserted, scan.points.size());
  }
  expect_equal(stock, map.snapshot().tree());
}

/// A rough wall whose points one ray stands for in each cube of two voxels and more: all that was hit is
/// blocked.
TEST(ScanRays, ThinningTakesRaysAndNoHits) {
  for (const bool drops_outliers : {false, true}) {
    Dice dice(9);
    Scan scan;
    for (int i = 0; i < 4000; ++i)
      scan.points.emplace_back(static_cast<float>(dice.uniform(1.9, 2.1)),
                               static_cast<float>(dice.uniform(-1, 1)),
                               static_cast<float>(dice.uniform(-1, 1)));
    if (drops_outliers) scan.points.emplace_back(0.52F, 0.02F, 0.02F);
    ScanFilter filter{.thin_to = 0.13};
    if (drops_outliers) filter.outlier_neighbours = 8, filter.outlier_deviations = 6.0;
    FreeSpaceMap safe({.resolution = 0.05}), rays_alone({.resolution = 0.05, .integration = compatible});
    safe.insert(scan, filter);
    EXPECT_EQ(rays_alone.insert(scan, filter).inserted, filter_points(scan, filter).points.size());
    std::size_t lost = 0;
    for (int i = 0; i < 4000; ++i) {
      const Eigen::Vector3d point = scan.points[static_cast<std::size_t>(i)].cast<double>();
      EXPECT_EQ(safe.snapshot().state(point), VoxelState::occupied) << point.transpose();
      lost += rays_alone.snapshot().state(point) != VoxelState::occupied;
    }
    EXPECT_GT(lost, 1000U);  // what a filter before OctoMap makes of it
    const VoxelState outlier = safe.snapshot().state({0.52, 0.02, 0.02});
    EXPECT_NE(outlier, VoxelState::occupied);
  }
}

/// Beyond the range nothing is a hit, whether a ray stands for it or another one does.
TEST(ScanRays, ThinningKeepsHitsUpToTheRangeAlone) {
  Dice dice(10);
  Scan scan;
  for (int i = 0; i < 2000; ++i)
    scan.points.emplace_back(static_cast<float>(dice.uniform(0.9, 1.3)),
                             static_cast<float>(dice.uniform(-0.1, 0.1)),
                             static_cast<float>(dice.uniform(-0.1, 0.1)));
  FreeSpaceMap map({.resolution = 0.02});
  map.insert(scan, {.max_range = 1.1, .thin_to = 0.1});
  const Snapshot now = map.snapshot();
  std::size_t beyond = 0;
  for (const Eigen::Vector3f& point : scan.points) {
    const double range = point.norm();
    if (range > 1.1 && range < 1.14) continue;  // in the voxel of one that is not
    EXPECT_EQ(now.state(point.cast<double>()) == VoxelState::occupied, range <= 1.1) << range;
    beyond += range > 1.1;
  }
  EXPECT_GT(beyond, 500U);
}

/// Points that rounding may put on either side of it.
TEST(ScanRays, ThinningKeepsHitsOnABorderBetweenItsCubes) {
  for (const float x : {0.3F, 0.7F, 1.1F, 1.3F, 2.3F}) {
    Dice dice(11);
    Scan scan;
    for (int i = 0; i < 4000; ++i)
      scan.points.emplace_back(x, static_cast<float>(dice.uniform(-0.5, 0.5)),
                               static_cast<float>(dice.uniform(-0.5, 0.5)));
    FreeSpaceMap map({.resolution = 0.05});
    map.insert(scan, {.thin_to = 0.1, .outlier_neighbours = 8, .outlier_deviations = 3.0});
    const Snapshot snapshot = map.snapshot();
    std::size_t lost = 0;
    for (const Eigen::Vector3f& point : scan.points)
      lost += snapshot.state(point.cast<double>()) != VoxelState::occupied;
    EXPECT_LT(lost, 200U) << x;  // of cubes at the corners, whose rays stand apart
  }
}

TEST(ScanRays, EachSettingOfTheFilterCountsAlone) {
  Scan scan;
  for (int i = 0; i < 40; ++i) scan.points.emplace_back(0.3f + 0.01f * static_cast<float>(i), 0.0f, 0.0f);
  const auto dropped = [&](const ScanFilter& filter) {
    FreeSpaceMap map({.resolution = 0.05});
    return map.insert(scan, filter).dropped_filter;
  };
  EXPECT_EQ(dropped({}), 0U);
  ScanFilter filter;
  filter.min_range = 0.4;
  EXPECT_GT(dropped(filter), 5U);
  filter = {};
  filter.thin_to = 0.1;
  EXPECT_GT(dropped(filter), 20U);
  filter = {};
  filter.crop = {Eigen::Vector3d::Constant(-0.5), Eigen::Vector3d::Constant(0.5)};
  EXPECT_GT(dropped(filter), 15U);
  filter = {};
  filter.bodies = {{{0.5, 0.0, -1.0}, {0.5, 0.0, 1.0}, 0.05}};
  EXPECT_GT(dropped(filter), 5U);
  filter = {};
  filter.outlier_neighbours = 5;
  scan.points.emplace_back(2.0f, 1.0f, 0.0f);
  EXPECT_GT(dropped(filter), 0U);
}

/// Each ray against the rule: to its point, or to max_range; freeing up to there, in safe integration less
/// the noise of that range.
void expect_rays_by_the_rule(Dice& dice, Integration integration) {
  const FusedTree tree(0.01);
  ScanInsertion insertion{.integration = integration};
  insertion.margins.noise_constant = dice.uniform(0.0, 0.2);
  insertion.margins.noise_quadratic = dice.uniform(0.0, 0.1);
  insertion.margins.noise_limit = dice.uniform(0.1, 0.5);
  const ScanFilter filter{.max_range = dice.whole(0, 2) == 0 ? 0.0 : dice.uniform(0.5, 3.0)};
  Scan scan = random_scan(dice, 60);
  scan.clear_to = random_scan(dice, 60).points;
  scan.clear_to.emplace_back(0.0F, 0.0F, 0.0F);
  ScanWorkspace workspace;
  ScanCounts counts;
  const std::vector<RayEnd> rays = choose_rays(tree, scan, filter, insertion, workspace, counts).ends;
  ASSERT_EQ(rays.size(), scan.points.size() + scan.clear_to.size());
  ASSERT_EQ(counts.cleared, scan.clear_to.size());
  for (std::size_t i = 0; i < rays.size(); ++i) {
    const bool is_hit = i < scan.points.size();
    const Eigen::Vector3d way =
        scan.map_from_sensor.linear() *
        (is_hit ? scan.points[i] : scan.clear_to[i - scan.points.size()]).cast<double>();
    const bool is_beyond = filter.max_range > 0.0 && way.norm() > filter.max_range;
    const double length = is_beyond ? filter.max_range : way.norm();
    const Eigen::Vector3d end = scan.map_from_sensor.translation() + length * way.normalized();
    EXPECT_LT((rays[i].point.cast<double>() - end).norm(), 1e-5);
    const double sigma =
        std::min(insertion.margins.noise_constant + insertion.margins.noise_quadratic * length * length,
                 insertion.margins.noise_limit);
    const double reach =
        integration == compatible ? length : std::max(0.0, length - insertion.margins.sigmas * sigma);
    if (is_hit && (is_beyond || integration == compatible))
      EXPECT_EQ(rays[i].reach, HUGE_VALF);
    else
      EXPECT_NEAR(rays[i].reach, reach, 1e-5) << i << " " << length;
  }
}

TEST(ScanRays, OfHitsAndOfNothingMetEndAndFreeAsTheRuleSays) {
  Dice dice(12);
  for (int i = 0; i < 40; ++i) {
    for (const Integration integration : {compatible, Integration::safe})
      expect_rays_by_the_rule(dice, integration);
  }
}

/// So many scans along x that end far behind it free a voxel just before what an earlier scan hit.
int scans_until_free(const ScanAgreement& so_far, double most_called_free) {
  FusedTree tree(0.1);
  tree.add_agreement(so_far);
  ScanInsertion insertion{.integration = Integration::safe};
  insertion.margins.band = 0.1;
  insertion.margins.most_called_free = most_called_free;
  ScanWorkspace workspace;
  ScanEvidence evidence;
  const auto look = [&](float range) {
    Scan scan;
    scan.map_from_sensor = Eigen::Translation3d(0.05, 0.05, 0.05);
    scan.points.emplace_back(range, 0.0F, 0.0F);
    insert_scan(tree, scan, {}, insertion, workspace, &evidence);
  };
  const auto is_observed = [&](int x) {
    CellCube cube;
    const FusedNode* leaf = tree.find_leaf({x, 0, 0}, cube);
    return leaf != nullptr && leaf->observed();
  };
  look(1.0F);
  EXPECT_TRUE(is_observed(10));
  EXPECT_FALSE(is_observed(9)) << "the scan itself spares it";
  for (int scans = 1; scans < 9; ++scans) {
    look(3.0F);
    EXPECT_TRUE(is_observed(5));
    if (is_observed(9)) return scans;
  }
  return -1;
}

TEST(ScanRays, BesideHitsOneLookFreesNothingWhileScansDisagreeMoreThanTheyMay) {
  EXPECT_EQ(scans_until_free({100, 0}, 0.01), 1);
  EXPECT_EQ(scans_until_free({100, 1}, 0.01), 1) << "no more than they may";
  EXPECT_EQ(scans_until_free({100, 2}, 0.01), 2);
  EXPECT_EQ(scans_until_free({100, 100}, 0.5), 2);
  EXPECT_EQ(scans_until_free({100, 100}, 1.0), 1) << "never asked for";
}

TEST(ScanRays, ARangeThatIsNoDistanceIsRefusedAndNotTakenForNoFilter) {
  Scan scan;
  scan.points.emplace_back(1.0f, 0.0f, 0.0f);
  for (const double range : {-1.0, std::numeric_limits<double>::infinity(),
                             -std::numeric_limits<double>::infinity(), std::nan("")}) {
    FreeSpaceMap map({.resolution = 0.05});
    ScanFilter filter;
    filter.max_range = range;
    EXPECT_THROW(map.insert(scan, filter), std::invalid_argument) << range;
  }
}

}  // namespace scan_rays_test
}  // namespace clearway
