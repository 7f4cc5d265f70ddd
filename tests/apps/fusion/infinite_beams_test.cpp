// Beams of a 2D laser that met nothing, from a bag to the map.
#include <gtest/gtest.h>

#include <cmath>

#include "apps/fusion/fusion.hpp"
#include "datasets/sources/recording.hpp"
#include "tests/worlds/bags/scan_bag.hpp"
#include "tests/worlds/temporary_folder.hpp"

namespace clearway {
namespace infinite_beams_test {

/// A laser of 4 m that sees one post at 2 m, 8 cm wide, and nothing else; every 20th beam says nothing at
/// all.
class InfiniteBeams : public testing::Test {
 protected:
  InfiniteBeams() {
    worlds::ScanBag bag(folder_ / "a.mcap");
    bag.transform(9, "map", "laser", Eigen::Isometry3d(Eigen::Translation3d(0, 0, 0.5)), true);
    std::vector<float> ranges;
    for (int i = 0; i < beams; ++i) {
      const double angle = -1.0 + step * i;
      ranges.push_back(std::abs(angle) < 0.02 ? 2.0F : INFINITY);
      if (i % 20 == 0) ranges.back() = NAN;
    }
    for (int i = 0; i < 3; ++i)
      bag.sweep("/scan", 10.0 + 0.1 * i, "laser", {-1.0F, static_cast<float>(step), 0.0F, 4.0F}, ranges);
    bag.sort();
    bag.write();
    infinite_ = static_cast<std::size_t>(3 * std::count(ranges.begin(), ranges.end(), INFINITY));
  }
  Fusion fused(const std::string& more) {
    folder_.write("s.yaml",
                  "map: {resolution: 0.05}\nsource: {bag: {scans: [/scan], fixed_frame: map}" + more + "}\n");
    return fuse(folder_ / "a.mcap", {.setup_file = folder_ / "s.yaml"}, [](double) {});
  }
  static constexpr int beams = 1001;
  static constexpr double step = 0.002;
  TemporaryFolder folder_;
  std::size_t infinite_ = 0;
};

TEST_F(InfiniteBeams, AreLeftOutAndToldUnlessTheSetupLetsThemFreeSpace) {
  const Fusion plain = fused(""), clear = fused(", scans: {clear_infinite: true}");
  const Snapshot without = plain.map.snapshot(), with = clear.map.snapshot();
  const Eigen::Vector3d aside(2.0 * std::cos(0.6), 2.0 * std::sin(0.6), 0.51), post(1.99, 0.01, 0.51),
      behind(2.6, 0.01, 0.51), before(1.0, 0.01, 0.51), far(4.06 * std::cos(0.6), 4.06 * std::sin(0.6), 0.51);
  EXPECT_EQ(without.state(aside), VoxelState::unknown);
  EXPECT_EQ(with.state(aside), VoxelState::seen_free);
  for (const Snapshot& map : {without, with}) {
    EXPECT_EQ(map.state(post), VoxelState::occupied);
    EXPECT_EQ(map.state(before), VoxelState::seen_free);
    EXPECT_EQ(map.state(behind), VoxelState::unknown);
    EXPECT_EQ(map.state(far), VoxelState::unknown);
  }
  EXPECT_EQ(plain.counts.infinite_beams, infinite_);
  EXPECT_EQ(clear.counts.infinite_beams, infinite_);
  EXPECT_EQ(plain.counts.points.cleared, 0U);
  EXPECT_EQ(clear.counts.points.cleared, infinite_);
  EXPECT_EQ(plain.counts.points.inserted, clear.counts.points.inserted);
  ASSERT_EQ(plain.warnings.size(), 1U);
  EXPECT_NE(plain.warnings[0].find("`source: {scans: {clear_infinite: true}}`"), std::string::npos);
  ASSERT_EQ(clear.warnings.size(), 1U);
  EXPECT_NE(clear.warnings[0].find("free space up to range_max"), std::string::npos);
}

/// As a converted log has them (aces.rawlog: 11,139 readings of 50 m that its driver did not see).
TEST_F(InfiniteBeams, ThatAreCalledAReturnOfTheLargestRangeAreTold) {
  for (const bool is_spike : {true, false}) {
    worlds::ScanBag bag(folder_ / "a.mcap");
    bag.transform(9, "map", "laser", Eigen::Isometry3d(Eigen::Translation3d(0, 0, 0.5)), true);
    std::vector<float> ranges;
    for (int i = 0; i < beams; ++i)  // walls as far as 20 m
      ranges.push_back(i % 5 == 0 ? (is_spike ? 50.0F : 20.0F + 0.1F * static_cast<float>(i % 97))
                                  : 1.0F + 0.019F * static_cast<float>(i));
    bag.sweep("/scan", 10, "laser", {-1.0F, static_cast<float>(step), 0.0F, 80.0F}, ranges);
    bag.sort();
    bag.write();
    const Fusion fusion = fused("");
    ASSERT_EQ(fusion.warnings.size(), is_spike ? 1U : 0U);
    if (!is_spike) continue;
    EXPECT_NE(fusion.warnings[0].find("201 of 1,001 readings of laser '/scan' are 50 m, its largest"),
              std::string::npos)
        << fusion.warnings[0];
    EXPECT_NE(fusion.warnings[0].find("no_return: 49.999"), std::string::npos) << fusion.warnings[0];
    const Fusion cured = fused(", scans: {no_return: 49.999}"),
                 cleared = fused(", scans: {no_return: 49.999, clear_infinite: true}");
    for (const Fusion* each : {&cured, &cleared}) {
      EXPECT_EQ(each->counts.infinite_beams, 201U);
      ASSERT_EQ(each->warnings.size(), 1U) << each->warnings.back();
      EXPECT_NE(each->warnings[0].find("no less than range_max or `no_return`"), std::string::npos)
          << each->warnings[0];
    }
    // Between a beam of the spike and its neighbours: beyond these nobody saw.
    const double angle = -1.0 + step * 200;
    const Eigen::Vector3d way(12.0 * std::cos(angle), 12.0 * std::sin(angle), 0.51),
        end(50.0 * std::cos(angle), 50.0 * std::sin(angle), 0.51);
    EXPECT_EQ(fusion.map.snapshot().state(end), VoxelState::occupied);
    EXPECT_EQ(cured.map.snapshot().state(end), VoxelState::unknown);
    EXPECT_EQ(cured.map.snapshot().state(way), VoxelState::unknown);
    EXPECT_EQ(cleared.map.snapshot().state(end), VoxelState::unknown);
    EXPECT_EQ(cleared.map.snapshot().state(way), VoxelState::seen_free);
  }
}

/// The readings count as they were read, not by where the moving laser's parts of a turn have them.
TEST_F(InfiniteBeams, OfALaserThatMovesAreTakenByTheirReadings) {
  worlds::ScanBag bag(folder_ / "a.mcap");
  for (int i = 0; i <= 20; ++i)
    bag.transform(9.9 + 0.05 * i, "map", "laser", Eigen::Isometry3d(Eigen::Translation3d(0.05 * i, 0, 0.5)),
                  false);
  std::vector<float> ranges;
  for (int i = 0; i < beams; ++i)
    ranges.push_back(i % 5 == 0 ? 50.0F : 1.0F + 0.019F * static_cast<float>(i));
  bag.sweep("/scan", 10, "laser", {-1.0F, static_cast<float>(step), 2e-4F, 80.0F}, ranges);
  bag.sort();
  bag.write();
  const Fusion fusion = fused(", scans: {no_return: 50}");
  EXPECT_EQ(fusion.counts.infinite_beams, 201U);
  std::size_t far = 0;
  fusion.map.snapshot().visit_leaves([&](const Voxel& leaf) { far += leaf.center.norm() > 30.0; });
  EXPECT_EQ(far, 0U);
}

TEST_F(InfiniteBeams, OfARawlogAreTakenByTheirReadingsToo) {
  const std::string log = "/usr/share/mrpt/datasets/localization_demo.rawlog";
  std::size_t nearer = 0, all = 0;
  RecordingReader reader(log);
  while (const auto frame = reader.next()) {
    const auto* cloud = std::get_if<CloudFrame>(&frame->content);
    if (cloud == nullptr || cloud->kind != "laser2d") continue;
    all += cloud->points.size();
    for (const Eigen::Vector3f& point : cloud->points) nearer += point.norm() < 5.0F;
  }
  ASSERT_GT(nearer, 1000U);
  ASSERT_GT(all, nearer + 1000);
  const auto fused_with = [&](const std::string& scans) {
    folder_.write("r.yaml", "map: {resolution: 0.1}\nsource: {scans: {" + scans + "}}\n");
    return fuse(log, {.setup_file = folder_ / "r.yaml"}, [](double) {});
  };
  const Fusion plain = fused_with("clear_infinite: false"), cut = fused_with("no_return: 5"),
               clear = fused_with("no_return: 5, clear_infinite: true");
  EXPECT_EQ(plain.counts.infinite_beams, 0U);
  EXPECT_EQ(plain.counts.points.inserted, all);
  for (const Fusion* each : {&cut, &clear}) {
    EXPECT_EQ(each->counts.infinite_beams, all - nearer);
    EXPECT_EQ(each->counts.beams_at_range, all - nearer);
    EXPECT_EQ(each->counts.points.inserted, nearer);
  }
  EXPECT_EQ(cut.counts.points.cleared, 0U);
  EXPECT_EQ(clear.counts.points.cleared, all - nearer);
}

TEST_F(InfiniteBeams, ThatReadTheLargestRangeAreTheSameAndTold) {
  worlds::ScanBag bag(folder_ / "a.mcap");
  bag.transform(9, "map", "laser", Eigen::Isometry3d(Eigen::Translation3d(0, 0, 0.5)), true);
  bag.sweep("/scan", 10, "laser", {-0.1F, 0.1F, 0.0F, 4.0F}, {INFINITY, 2.0F, 4.0F});
  bag.write();
  const Fusion plain = fused(""), clear = fused(", scans: {clear_infinite: true}");
  const Eigen::Vector3d end(3.99 * std::cos(0.1), 3.99 * std::sin(0.1), 0.51),
      way(3.0 * std::cos(0.1), 3.0 * std::sin(0.1), 0.51);
  EXPECT_EQ(plain.map.snapshot().state(end), VoxelState::unknown);
  EXPECT_EQ(plain.map.snapshot().state(way), VoxelState::unknown);
  EXPECT_EQ(clear.map.snapshot().state(way), VoxelState::seen_free);
  EXPECT_EQ(clear.counts.points.cleared, 2U);
  ASSERT_EQ(plain.warnings.size(), 1U);
  EXPECT_TRUE(
      plain.warnings[0].starts_with("2 beams of laser scans are +inf or, 1 of them, no less than "
                                    "range_max"))
      << plain.warnings[0];
}

TEST_F(InfiniteBeams, OfARangeThatNoLaserHasFreeNothingWithoutAMaxRange) {
  worlds::ScanBag bag(folder_ / "a.mcap");
  bag.transform(9, "map", "laser", Eigen::Isometry3d(Eigen::Translation3d(0, 0, 0.5)), true);
  bag.sweep("/scan", 10, "laser", {-0.1F, 0.1F, 0.0F, 1000.0F}, {INFINITY, 2.0F, INFINITY});
  bag.write();
  EXPECT_EQ(fused(", scans: {clear_infinite: true}").counts.points.cleared, 0U);
  folder_.write("m.yaml",
                "map: {resolution: 0.05, max_range: 5}\n"
                "source: {bag: {scans: [/scan], fixed_frame: map}, scans: {clear_infinite: true}}\n");
  const Fusion near = fuse(folder_ / "a.mcap", {.setup_file = folder_ / "m.yaml"}, [](double) {});
  EXPECT_EQ(near.counts.points.cleared, 2U);
  EXPECT_EQ(near.map.snapshot().state({4.5 * std::cos(0.1), 4.5 * std::sin(0.1), 0.51}),
            VoxelState::seen_free);
  EXPECT_EQ(near.map.snapshot().state({5.1 * std::cos(0.1), 5.1 * std::sin(0.1), 0.51}), VoxelState::unknown);
}

}  // namespace infinite_beams_test
}  // namespace clearway
