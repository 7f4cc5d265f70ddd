// Erasing and undoing on whole maps, against maps on which the undone strokes never were.

#include <gtest/gtest.h>

#include <set>

#include "mapping/free_space_map.hpp"
#include "mapping/history/provenance.hpp"
#include "mapping/voxels/fused_tree.hpp"
#include "tests/worlds/random_map.hpp"

namespace clearway {
namespace erase_undo_test {

using worlds::Dice;

struct Step {
  enum Kind { paint, erase, scan } kind = paint;
  int stroke = 0, volume = 0;
  Sphere sphere;
  unsigned seed = 0;  ///< of the scan
};

/// Strokes of spheres and erasers on three volumes, scans in between.
std::vector<Step> random_steps(unsigned seed, int strokes) {
  Dice dice(seed);
  std::vector<Step> steps;
  for (int stroke = 0; stroke < strokes; ++stroke) {
    const bool erases = dice.whole(0, 3) == 0;
    for (int i = dice.whole(1, 4); i > 0; --i) {
      const bool mixed = dice.whole(0, 9) == 0;
      steps.push_back({erases != mixed ? Step::erase : Step::paint,
                       stroke,
                       dice.whole(0, 2),
                       {dice.point(0.5), dice.uniform(0.05, 0.35)}});
    }
    if (dice.whole(0, 1) == 0) steps.push_back({Step::scan, stroke, 0, {}, seed + 1000U * (stroke + 1U)});
  }
  return steps;
}

/// Plays the steps but for the strokes left out; all strokes are begun, so that numbers agree.
FreeSpaceMap play(const std::vector<Step>& steps, const std::set<int>& left_out) {
  FreeSpaceMap map({.resolution = 0.05});
  for (const char* label : {"a", "b", "c"}) map.add_volume(label, {});
  int stroke = -1;
  for (const Step& step : steps) {
    if (step.stroke != stroke) stroke = map.begin_stroke("stroke " + std::to_string(step.stroke), "test");
    if (step.kind == Step::scan) {
      Dice dice(step.seed);
      map.insert(worlds::random_scan(dice, 100));
      continue;
    }
    if (left_out.contains(step.stroke)) continue;
    if (step.kind == Step::paint) map.paint(step.volume, step.sphere, 1.0 * stroke);
    if (step.kind == Step::erase) map.erase(step.volume, step.sphere, 1.0 * stroke);
  }
  return map;
}

void expect_same(const FreeSpaceMap& a, const FreeSpaceMap& b, const std::string& which) {
  const Snapshot first = a.snapshot(), second = b.snapshot();
  EXPECT_TRUE(first.tree() == second.tree()) << which;
  EXPECT_EQ(first.tree().size(), second.tree().size()) << which;
  ASSERT_EQ(a.volumes().size(), b.volumes().size());
  for (std::size_t v = 0; v < a.volumes().size(); ++v) {
    const PaintedVolume &mine = a.volumes()[v], &theirs = b.volumes()[v];
    EXPECT_EQ(mine.times, theirs.times);
    EXPECT_EQ(mine.strokes, theirs.strokes);
    EXPECT_EQ(mine.stroke_of, theirs.stroke_of);
    ASSERT_EQ(mine.spheres.size(), theirs.spheres.size());
    for (std::size_t i = 0; i < mine.spheres.size(); ++i) {
      EXPECT_EQ(mine.spheres[i].center, theirs.spheres[i].center);
      EXPECT_EQ(mine.spheres[i].radius, theirs.spheres[i].radius);
    }
  }
}

TEST(Undo, LeavesTheMapOnWhichTheStrokesNeverWere) {
  for (unsigned seed = 0; seed < 40; ++seed) {
    Dice dice(seed);
    const int strokes = dice.whole(1, 8);
    const std::vector<Step> steps = random_steps(seed, strokes);
    FreeSpaceMap map = play(steps, {});
    std::set<int> undone;
    for (int i = dice.whole(1, 3); i > 0; --i) {
      const int stroke = dice.whole(0, strokes - 1);
      EXPECT_EQ(map.undo_stroke(stroke), stroke);
      undone.insert(stroke);
      expect_same(map, play(steps, undone), "seed " + std::to_string(seed));
    }
  }
}

TEST(Undo, TakesTheLastStrokeThatIsNotUndone) {
  FreeSpaceMap map({.resolution = 0.05});
  map.add_volume("v", {});
  EXPECT_EQ(map.undo_stroke(), -1);
  map.paint(0, {{0, 0, 0}, 0.2});  // belongs to no stroke
  map.begin_stroke("first");
  map.paint(0, {{1, 0, 0}, 0.2});
  map.begin_stroke("second");
  map.paint(0, {{2, 0, 0}, 0.2});
  EXPECT_EQ(map.undo_stroke(), 1);
  map.paint(0, {{3, 0, 0}, 0.2});  // undoing ended the stroke
  EXPECT_EQ(map.undo_stroke(), 0);
  EXPECT_EQ(map.undo_stroke(), -1);
  EXPECT_THROW(map.undo_stroke(2), std::invalid_argument);
  EXPECT_THROW(map.undo_stroke(-1), std::invalid_argument);
  EXPECT_THROW(map.begin_stroke("two\nlines"), std::invalid_argument);
  ASSERT_EQ(map.volumes()[0].spheres.size(), 2U);
  EXPECT_EQ(map.snapshot().state({3.0, 0.0, 0.0}), VoxelState::painted);
  EXPECT_EQ(map.snapshot().state({2.0, 0.0, 0.0}), VoxelState::unknown);
}

TEST(Erase, LeavesThePaintThatTheRemainingSpheresMake) {
  for (unsigned seed = 0; seed < 20; ++seed) {
    const FreeSpaceMap map = play(random_steps(seed, 6), {});
    FusedTree expected(0.05);
    for (int v = 0; v < 3; ++v) {
      for (const Sphere& sphere : map.volumes()[static_cast<std::size_t>(v)].spheres)
        expected.paint(v, sphere);
    }
    const Snapshot snapshot = map.snapshot();
    std::size_t painted = 0, compared = 0;
    expected.visit_leaves([&](const FusedNode& node, const CellCube& cube) {
      painted += node.painted() != 0 ? cube.volume() : 0;
    });
    snapshot.visit_leaves([&](const Voxel& voxel) {
      if (voxel.volumes == 0) return;
      const int edge = static_cast<int>(std::lround(voxel.size / 0.05));
      compared += CellCube{{0, 0, 0}, edge}.volume();
      CellCube cube;
      const FusedNode* node = expected.find_leaf(*expected.cell(voxel.center), cube);
      ASSERT_NE(node, nullptr);
      EXPECT_EQ(node->painted(), voxel.volumes);
    });
    EXPECT_EQ(painted, compared);
  }
}

TEST(Erase, ClearsEveryVoxelThatTheEraserOverlaps) {
  Dice dice(3);
  std::size_t cleared = 0;
  for (int trial = 0; trial < 20; ++trial) {
    FreeSpaceMap map({.resolution = 0.04});
    map.add_volume("v", {});
    for (int i = 0; i < 10; ++i) map.paint(0, worlds::random_sphere(dice));
    const Sphere eraser{dice.point(0.5), dice.uniform(0.1, 0.4)};
    cleared += map.erase(0, eraser).unpainted;
    map.snapshot().visit_leaves([&](const Voxel& voxel) {
      const Eigen::Array3d outside = ((voxel.center - eraser.center).array().abs() - voxel.size / 2).max(0.0);
      EXPECT_GE(outside.matrix().norm(), eraser.radius * (1 - 1e-12));
    });
  }
  EXPECT_GT(cleared, 500U);
}

TEST(Erase, CountsSpheresAndVoxelsAndLeavesOthersAlone) {
  FreeSpaceMap map({.resolution = 0.05});
  map.add_volume("mine", {});
  map.add_volume("theirs", {});
  for (int v : {0, 1}) {
    map.paint(v, {{0.0, 0.0, 0.0}, 0.3});
    map.paint(v, {{0.5, 0.0, 0.0}, 0.3});
    map.paint(v, {{2.0, 0.0, 0.0}, 0.3});
  }
  const std::size_t before = map.snapshot().counts().painted;
  const EraseCounts counts = map.erase(0, {{-0.1, 0.0, 0.0}, 0.4});
  EXPECT_EQ(counts.removed, 1U);
  EXPECT_EQ(counts.shrunk, 1U);
  EXPECT_GT(counts.unpainted, 100U);
  EXPECT_NEAR(map.volumes()[0].spheres[0].radius, 0.2, 1e-12);
  EXPECT_EQ(map.volumes()[1].spheres.size(), 3U);
  EXPECT_EQ(map.snapshot().counts().painted, before);  // the other volume paints there still
  map.paint(0, {{0.0, 0.0, 0.0}, 0.3});                // what comes later is whole
  EXPECT_EQ(map.snapshot().voxel({0.02, 0.02, 0.02}).volumes, 3U);
  EXPECT_THROW(map.erase(2, {{0, 0, 0}, 0.1}), std::invalid_argument);
  EXPECT_THROW(map.erase(0, {{0, 0, 0}, 0.0}), std::invalid_argument);
}

TEST(Erase, ASnapshotTakenBeforeStaysPainted) {
  FreeSpaceMap map({.resolution = 0.05});
  map.add_volume("v", {});
  map.paint(0, {{0.0, 0.0, 0.0}, 0.3});
  const Snapshot before = map.snapshot();
  map.erase(0, {{0.0, 0.0, 0.0}, 0.1});
  EXPECT_EQ(before.state({0.02, 0.02, 0.02}), VoxelState::painted);
  EXPECT_EQ(map.snapshot().state({0.02, 0.02, 0.02}), VoxelState::unknown);
  EXPECT_EQ(before.volumes()[0].spheres.size(), 1U);
}

/// A stroke into a wall, in a volume that is taken back with it: the record of the map names it no more.
TEST(RemoveLastVolume, LeavesNothingOfIt) {
  FreeSpaceMap map({.resolution = 0.05});
  Scan scan;
  scan.points = {{0.5F, 0.0F, 0.0F}, {0.5F, 0.06F, 0.0F}};
  map.insert(scan);
  map.add_volume("kept", {});
  map.begin_stroke("first");
  map.paint(0, {{0.2, 0.0, 0.0}, 0.15});
  map.add_volume("wrong", {"tool"});
  EXPECT_EQ(map.begin_stroke("into the wall"), 1);
  map.paint(1, {{0.5, 0.0, 0.0}, 0.2});
  EXPECT_FALSE(map.conflicts().records.empty());
  EXPECT_FALSE(map.remove_last_volume());  // it is painted
  EXPECT_EQ(map.volumes().size(), 2U);
  map.undo_stroke();
  EXPECT_TRUE(map.remove_last_volume());
  EXPECT_EQ(map.volumes().size(), 1U);
  EXPECT_TRUE(map.conflicts().records.empty());
  const Provenance provenance = map.provenance();
  EXPECT_NO_THROW(parse_provenance(format_provenance(provenance), "provenance.bin"));
  EXPECT_EQ(map.add_volume("right", {}), 1);
  EXPECT_FALSE(map.remove_last_volume() && map.remove_last_volume());  // "kept" is painted
}

}  // namespace erase_undo_test
}  // namespace clearway
