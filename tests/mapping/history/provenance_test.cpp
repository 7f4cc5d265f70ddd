// What made a voxel what it is, against brute force: each scan inserted alone into a map of its own.

#include "mapping/history/provenance.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <fstream>

#include "mapping/files/map_file.hpp"
#include "mapping/files/octree_check.hpp"
#include "mapping/free_space_map.hpp"
#include "mapping/voxels/fused_tree.hpp"
#include "tests/worlds/random_map.hpp"
#include "tests/worlds/temporary_folder.hpp"

namespace clearway {
namespace provenance_test {

using worlds::Dice;

/// What one scan does to an empty map: hit and missed voxels.
class ScanAlone {
 public:
  ScanAlone(const Scan& scan, const ScanFilter& filter, const MapOptions& options) : map_(options) {
    map_.insert(scan, filter);
    snapshot_ = map_.snapshot();
  }
  bool touched(const Eigen::Vector3d& point) const { return snapshot_.voxel(point).observed; }
  bool hit(const Eigen::Vector3d& point) const {
    return touched(point) && snapshot_.voxel(point).log_odds > 0;
  }

 private:
  FreeSpaceMap map_;
  Snapshot snapshot_;
};

TEST(Provenance, NamesExactlyTheScansWhoseInsertionTouchedAVoxel) {
  std::size_t hits = 0, misses = 0, untouched = 0;
  for (unsigned seed = 0; seed < 4; ++seed) {
    Dice dice(seed);
    MapOptions options{.resolution = seed % 2 == 0 ? 0.05 : 0.013};
    options.discretize = seed >= 2;
    options.margins.most_called_free = 1.0;  // else what a scan frees depends on the scans before it
    FreeSpaceMap map(options);
    map.keep_scans();
    ScanFilter filter;
    filter.max_range = seed == 1 ? 0.8 : 0.0;
    std::vector<ScanAlone> alone;
    for (int i = 0; i < 8; ++i) {
      Scan scan = worlds::random_scan(dice, 300);
      scan.time = i;
      scan.sensor = i % 2 == 0 ? "left" : "right";
      map.insert(scan, filter);
      alone.emplace_back(scan, filter, options);
    }
    const Provenance provenance = map.provenance();
    const FusedTree grid(options.resolution);
    for (int trial = 0; trial < 800; ++trial) {
      const Eigen::Vector3d point = dice.point(1.1);
      const ScanLog::Answer answer = provenance.scans.touched(*grid.cell(point));
      ScanLog::Answer expected;
      for (std::size_t i = 0; i < alone.size(); ++i) {
        if (!alone[i].touched(point)) continue;
        (alone[i].hit(point) ? expected.hits : expected.misses).push_back(i);
      }
      ASSERT_EQ(answer.hits, expected.hits);
      ASSERT_EQ(answer.misses, expected.misses);
      EXPECT_TRUE(answer.unknown.empty());
      hits += expected.hits.size();
      misses += expected.misses.size();
      untouched += expected.hits.empty() && expected.misses.empty() ? 1 : 0;
    }
    EXPECT_EQ(provenance.scans.scans()[3].sensor, "right");
    EXPECT_EQ(provenance.scans.scans()[3].time, 3.0);
  }
  EXPECT_GT(hits, 5U);
  EXPECT_GT(misses, 300U);
  EXPECT_GT(untouched, 30U);
}

TEST(Provenance, SaysWhichScansItForgotWhenTheBudgetIsUsedUp) {
  Dice dice(9);
  FreeSpaceMap full({.resolution = 0.02}), tight({.resolution = 0.02});
  full.keep_scans();
  for (int i = 0; i < 12; ++i) full.insert(worlds::random_scan(dice, 200));
  const ScanLog all = full.provenance().scans;
  tight.keep_scans(all.bytes() / 3);
  Dice again(9);
  for (int i = 0; i < 12; ++i) tight.insert(worlds::random_scan(again, 200));
  const ScanLog some = tight.provenance().scans;
  EXPECT_LE(some.bytes(), all.bytes() / 3);
  ASSERT_EQ(some.scans().size(), 12U);
  EXPECT_FALSE(some.scans().front().misses_kept);
  EXPECT_TRUE(some.scans().front().hits_kept);  // the hits are small and go last
  EXPECT_TRUE(some.scans().back().misses_kept);
  std::size_t unknown = 0;
  for (int trial = 0; trial < 500; ++trial) {
    const Eigen::Vector3i cell = (dice.point(1.0) / 0.02).array().floor().cast<int>();
    const auto truth = all.touched(cell), answer = some.touched(cell);
    EXPECT_EQ(answer.hits, truth.hits);
    for (const std::size_t scan : truth.misses) {  // known, or said to be unknown
      const bool known = std::count(answer.misses.begin(), answer.misses.end(), scan) == 1;
      const bool admitted = std::count(answer.unknown.begin(), answer.unknown.end(), scan) == 1;
      EXPECT_TRUE(known != admitted);
      unknown += admitted ? 1 : 0;
    }
    for (const std::size_t scan : answer.misses)
      EXPECT_EQ(std::count(truth.misses.begin(), truth.misses.end(), scan), 1);
  }
  EXPECT_GT(unknown, 50U);
  tight.keep_scans(0);
  tight.insert(worlds::random_scan(dice, 200));
  EXPECT_EQ(tight.provenance().scans.bytes(), 0U);
}

TEST(Provenance, NamesTheStrokesThatPaintedOrErasedAVoxel) {
  FreeSpaceMap map({.resolution = 0.05});
  map.add_volume("a", {});
  map.add_volume("b", {});
  map.begin_stroke("first", "hand");
  map.paint(0, {{0.0, 0.0, 0.0}, 0.3}, 1.0);
  map.paint(0, {{0.05, 0.0, 0.0}, 0.3}, 2.0);
  map.begin_stroke("second", "hand");
  map.paint(1, {{0.0, 0.0, 0.0}, 0.3}, 3.0);
  map.begin_stroke("eraser", "hand");
  map.erase(0, {{0.4, 0.0, 0.0}, 0.3}, 4.0);
  map.begin_stroke("undone", "hand");
  map.paint(0, {{0.0, 0.0, 0.0}, 0.3}, 5.0);
  map.undo_stroke();
  const Provenance provenance = map.provenance();
  const auto at = [&](double x) { return strokes_at(provenance, {static_cast<int>(x / 0.05), 0, 0}); };
  // The spheres reach to x = 0.3 and 0.35 and after erasing to 0.1: the voxel 0.15..0.2 lost both.
  const auto lost = at(0.151);
  ASSERT_EQ(lost.size(), 2U);
  EXPECT_EQ(lost[0].volume, 1);
  EXPECT_EQ(lost[0].stroke, 1);
  EXPECT_FALSE(lost[0].erases);
  EXPECT_EQ(lost[1].stroke, 2);
  EXPECT_TRUE(lost[1].erases);
  EXPECT_EQ(lost[1].spheres, 1U);
  EXPECT_EQ(lost[1].first, 4.0);
  const auto inside =
      at(0.001);  // 0..0.05: still in the first sphere (0.1) and, from 0.05, in the second (0.05)
  ASSERT_GE(inside.size(), 2U);
  EXPECT_EQ(inside[0].stroke, 0);
  EXPECT_EQ(inside[0].first, 1.0);
  EXPECT_TRUE(at(2.0).empty());
}

TEST(Provenance, StrokesAgreeWithThePaintOfEveryVoxel) {
  for (unsigned seed = 0; seed < 6; ++seed) {
    Dice dice(seed);
    FreeSpaceMap map({.resolution = 0.06});
    map.add_volume("a", {});
    map.add_volume("b", {});
    for (int i = 0; i < 14; ++i) {
      map.begin_stroke(std::to_string(i));
      const int volume = dice.whole(0, 1);
      const Sphere sphere = worlds::random_sphere(dice);
      i % 3 == 2 ? static_cast<void>(map.erase(volume, sphere))
                 : static_cast<void>(map.paint(volume, sphere));
    }
    const Snapshot snapshot = map.snapshot();
    const Provenance provenance = map.provenance();
    std::size_t painted = 0;
    for (int trial = 0; trial < 4000; ++trial) {
      const Eigen::Vector3i cell(dice.whole(-15, 15), dice.whole(-15, 15), dice.whole(-15, 15));
      unsigned mask = 0;
      for (const StrokeTouch& touch : strokes_at(provenance, cell)) {
        if (!touch.erases) mask |= 1U << touch.volume;
      }
      const Eigen::Vector3d center = (cell.cast<double>().array() + 0.5) * 0.06;
      ASSERT_EQ(mask, snapshot.voxel(center).volumes);
      painted += mask != 0 ? 1 : 0;
    }
    EXPECT_GT(painted, 20U);
  }
}

Provenance sample() {
  Dice dice(5);
  FreeSpaceMap map({.resolution = 0.04});
  map.keep_scans();
  map.add_volume("tunnel, \"quoted\"", {"tool"});
  map.add_volume("dock", {});
  for (int i = 0; i < 4; ++i) {
    map.begin_stroke("stroke " + std::to_string(i), "hand");
    map.paint(i % 2, worlds::random_sphere(dice), i);
    Scan scan = worlds::random_scan(dice, 150);
    scan.sensor = "kinect";
    map.insert(scan);
    map.erase(i % 2, {dice.point(0.5), 0.1}, i);
  }
  Provenance provenance = map.provenance();
  provenance.map_sha256 = std::string(64, 'a');
  return provenance;
}

TEST(ProvenanceFile, ReadsBackEverything) {
  const Provenance written = sample();
  const std::string bytes = format_provenance(written);
  const Provenance read = parse_provenance(bytes, "provenance.bin");
  EXPECT_EQ(format_provenance(read), bytes);
  EXPECT_EQ(read.volumes, written.volumes);
  EXPECT_EQ(read.strokes, written.strokes);
  EXPECT_EQ(read.events.size(), 8U);
  EXPECT_EQ(read.scans.scans().size(), 4U);
  Dice dice(6);
  for (int trial = 0; trial < 500; ++trial) {
    const Eigen::Vector3i cell(dice.whole(-25, 25), dice.whole(-25, 25), dice.whole(-25, 25));
    EXPECT_EQ(read.scans.touched(cell).hits, written.scans.touched(cell).hits);
    EXPECT_EQ(read.scans.touched(cell).misses, written.scans.touched(cell).misses);
  }
}

TEST(ProvenanceFile, RefusesEveryDamage) {
  const std::string bytes = format_provenance(sample());
  Dice dice(7);
  for (std::size_t length = 0; length < bytes.size(); length += 1 + bytes.size() / 500)
    EXPECT_THROW(parse_provenance(bytes.substr(0, length), "p"), DamagedFile);
  for (int i = 0; i < 500; ++i) {
    std::string damaged = bytes;
    damaged[static_cast<std::size_t>(dice.whole(0, static_cast<int>(bytes.size()) - 1))] ^=
        static_cast<char>(1 << dice.whole(0, 7));
    EXPECT_THROW(parse_provenance(damaged, "p"), DamagedFile);
  }
}

TEST(ProvenanceFile, SurvivesDamageThatCarriesTheRightChecksum) {
  const std::string bytes = format_provenance(sample());
  const auto body = bytes.find("data\n") + 5;
  const std::string head = bytes.substr(0, bytes.find('\n') + 1);
  Dice dice(8);
  int refused = 0;
  for (int i = 0; i < 1000; ++i) {
    std::string damaged = bytes.substr(body);
    for (int j = dice.whole(1, 4); j > 0; --j) {
      damaged[static_cast<std::size_t>(dice.whole(0, static_cast<int>(damaged.size()) - 1))] =
          static_cast<char>(dice.whole(-128, 127));
    }
    const std::string after = "data\n" + damaged;
    try {
      const Provenance read = parse_provenance(head + seal_line(head, after) + after, "p");
      static_cast<void>(read.scans.touched({1, 2, 3}));
      static_cast<void>(strokes_at(read, {0, 0, 0}));
    } catch (const DamagedFile&) {
      ++refused;
    }
  }
  EXPECT_GT(refused, 100);
}

TEST(ProvenanceFile, LiesBesideTheMapThatItBelongsTo) {
  const TemporaryFolder folder;
  const Snapshot map = worlds::random_map(1).snapshot();
  save_map(map, folder.path());
  EXPECT_FALSE(load_provenance(folder.path()).has_value());
  save_provenance(sample(), folder.path());
  const auto read = load_provenance(folder.path());
  ASSERT_TRUE(read.has_value());
  EXPECT_EQ(read->map_sha256, map_sha256(folder.path()));
  EXPECT_FALSE(load_provenance(folder.path() / "map.ot").has_value());
  std::ofstream(folder.path() / "provenance.bin") << "rubbish";
  EXPECT_THROW(load_provenance(folder.path()), DamagedFile);
}

}  // namespace provenance_test
}  // namespace clearway
