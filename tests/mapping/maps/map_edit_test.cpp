// Merging, cropping and coarsening, voxel by voxel against what the rules say of the sources.

#include "mapping/maps/map_edit.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <memory>

#include "mapping/maps/map_difference.hpp"
#include "mapping/voxels/fused_tree.hpp"
#include "tests/worlds/random_map.hpp"

namespace clearway {
namespace map_edit_test {

using worlds::Dice;

constexpr double edge = 0.05;

Eigen::Vector3d center(const Eigen::Vector3i& cell, double resolution = edge) {
  return (cell.cast<double>().array() + 0.5) * resolution;
}

/// Calls `check` for random cells of a cube around the origin that holds all random maps.
template <class Check>
void for_random_cells(int reach, int count, const Check& check) {
  Dice dice(17);
  for (int i = 0; i < count; ++i) {
    const auto any = [&] { return dice.whole(-reach, reach - 1); };
    const int x = any(), y = any();
    check(Eigen::Vector3i(x, y, any()));
  }
}

/// The labels of the volumes that paint a voxel, sorted.
std::vector<std::string> labels(const Snapshot& map, const Voxel& voxel) {
  std::vector<std::string> result;
  for (std::size_t v = 0; v < map.volumes().size(); ++v) {
    if ((voxel.volumes >> v & 1U) != 0) result.push_back(map.volumes()[v].label);
  }
  std::sort(result.begin(), result.end());
  return result;
}

/// A map with volumes "dock" and "lift", so that one label is random_map's and one is not.
Snapshot other_map(unsigned seed) {
  Dice dice(seed);
  FreeSpaceMap map({.resolution = edge});
  map.add_volume("lift", {});
  map.add_volume("dock", {"base"});
  for (int i = 0; i < 4; ++i) {
    map.paint(dice.whole(0, 1), worlds::random_sphere(dice));
    map.insert(worlds::random_scan(dice, 200));
  }
  return map.snapshot();
}

/// Against the map that painted the same spheres itself, after its scans.
TEST(WithPainted, IsWhatPaintingTheMapWouldHaveMade) {
  for (unsigned seed = 0; seed < 4; ++seed) {
    Dice dice(seed);
    FreeSpaceMap map({.resolution = edge});
    map.add_volume("dock", {"base"});
    map.paint(0, worlds::random_sphere(dice), 1.0);
    map.insert(worlds::random_scan(dice, 300));
    const Snapshot before = map.snapshot();
    PaintedVolume dock{"dock", {"base"}}, lift{"lift", {}};
    map.add_volume("lift", {});
    for (int i = 0; i < 6; ++i) {
      const Sphere sphere = worlds::random_sphere(dice);
      (i % 2 == 0 ? lift : dock).add(sphere, 2.0 + i, -1);
      map.paint(i % 2 == 0 ? 1 : 0, sphere, 2.0 + i);
    }
    const Snapshot painted = with_painted(before, {lift, dock}), expected = map.snapshot();
    EXPECT_TRUE(painted.tree() == expected.tree()) << seed;
    ASSERT_EQ(painted.volumes().size(), 2U);
    for (std::size_t v = 0; v < 2; ++v) {
      EXPECT_EQ(painted.volumes()[v].label, expected.volumes()[v].label);
      EXPECT_EQ(painted.volumes()[v].spheres.size(), expected.volumes()[v].spheres.size());
    }
    EXPECT_TRUE(before.tree() == with_painted(before, {}).tree());
    EXPECT_THROW(with_painted(before, {PaintedVolume{"dock", {"tool"}}}), std::invalid_argument);
    EXPECT_THROW(with_painted(before, {PaintedVolume{"more", {"tool", ""}}}), std::invalid_argument);
    EXPECT_THROW(with_painted(before, {PaintedVolume{"more\n", {}}}), std::invalid_argument);
    constexpr double nan = std::numeric_limits<double>::quiet_NaN(), infinity = HUGE_VAL;
    for (const Sphere& none : {Sphere{{0, 0, 0}, -1.0}, Sphere{{0, 0, 0}, 0.0}, Sphere{{0, 0, 0}, nan},
                               Sphere{{0, nan, 0}, infinity}, Sphere{{infinity, 0, 0}, 1.0}}) {
      PaintedVolume volume{"more", {}};
      volume.spheres = {{{0, 0, 0}, 0.1}, none};
      EXPECT_THROW(with_painted(before, {volume}), std::invalid_argument);
    }
  }
}

TEST(Merge, HoldsTheEvidenceAndPaintOfBoth) {
  std::size_t conflicts = 0, both = 0;
  for (unsigned seed = 0; seed < 3; ++seed) {
    const Snapshot a = worlds::random_map(seed, edge).snapshot(), b = other_map(seed + 100);
    const Snapshot merged = merge(a, b);
    const float threshold = a.tree().getOccupancyThresLog();
    for_random_cells(30, 10000, [&](const Eigen::Vector3i& cell) {
      const Voxel one = a.voxel(center(cell)), two = b.voxel(center(cell)), all = merged.voxel(center(cell));
      ASSERT_EQ(all.observed, one.observed || two.observed);
      if (one.observed && two.observed) {
        ++both;
        const auto [lower, higher] = std::minmax({one.log_odds, two.log_odds});
        ASSERT_EQ(all.log_odds, higher >= threshold ? higher : lower);
      } else if (all.observed) {
        ASSERT_EQ(all.log_odds, one.observed ? one.log_odds : two.log_odds);
      }
      std::vector<std::string> expected = labels(a, one), theirs = labels(b, two);
      expected.insert(expected.end(), theirs.begin(), theirs.end());
      std::sort(expected.begin(), expected.end());
      expected.erase(std::unique(expected.begin(), expected.end()), expected.end());
      ASSERT_EQ(labels(merged, all), expected);
      if (all.state == VoxelState::conflict && one.state != VoxelState::conflict &&
          two.state != VoxelState::conflict)
        ++conflicts;
    });
    ASSERT_EQ(merged.volumes().size(), 3U);
    EXPECT_EQ(merged.volumes()[1].spheres.size(),
              a.volumes()[1].spheres.size() + b.volumes()[1].spheres.size());
    EXPECT_FALSE(difference(merge(a, Snapshot(a)), merged).states.empty());
  }
  EXPECT_GT(conflicts, 2U);
  EXPECT_GT(both, 500U);
}

bool is_blocked(VoxelState state) { return state == VoxelState::occupied || state == VoxelState::conflict; }

TEST(Merge, LosesNoObstacle) {
  std::size_t against_free = 0, against_paint = 0;
  for (unsigned seed = 0; seed < 3; ++seed) {
    const Snapshot a = worlds::random_map(seed, edge, 8, 2000).snapshot(), b = other_map(seed + 100);
    for (const auto& [one, two] : {std::pair(a, b), std::pair(b, a)}) {
      const Snapshot merged = merge(one, two);
      for_random_cells(30, 20000, [&](const Eigen::Vector3i& cell) {
        const VoxelState first = one.state(center(cell)), second = two.state(center(cell));
        const Voxel all = merged.voxel(center(cell));
        ASSERT_EQ(is_blocked(all.state), is_blocked(first) || is_blocked(second));
        ASSERT_EQ(all.state == VoxelState::conflict, is_blocked(all.state) && all.volumes != 0);
        against_free += is_blocked(first) && second == VoxelState::seen_free ? 1 : 0;
        against_paint += is_blocked(first) && second == VoxelState::painted ? 1 : 0;
      });
    }
  }
  EXPECT_GT(against_free, 100U);
  EXPECT_GT(against_paint, 10U);
}

TEST(Merge, OneScanOfAThingInPaintThatWasSeenFreeForLongMakesConflicts) {
  FreeSpaceMap old({.resolution = edge}), newest({.resolution = edge});
  old.paint(old.add_volume("tunnel", {}), {{1.0, 0.0, 0.0}, 0.4});
  Scan wall, thing;
  for (float y = -0.5F; y <= 0.5F; y += 0.02F) {
    for (float z = -0.5F; z <= 0.5F; z += 0.02F) {
      wall.points.emplace_back(2.0F, y, z);
      if (std::abs(y) < 0.1F && std::abs(z) < 0.1F) thing.points.emplace_back(1.01F, y, z);
    }
  }
  for (int i = 0; i < 20; ++i) old.insert(wall);
  newest.insert(thing);
  const std::size_t hit = newest.snapshot().counts().occupied;
  EXPECT_GT(hit, 10U);
  EXPECT_EQ(merge(old.snapshot(), newest.snapshot()).counts().conflict, hit);
  EXPECT_EQ(merge(newest.snapshot(), old.snapshot()).counts().conflict, hit);
}

/// True when two maps say the same of random voxels, their volumes matched by label.
void expect_same(const Snapshot& a, const Snapshot& b) {
  EXPECT_FALSE(difference(a, b).any());
  for_random_cells(30, 10000, [&](const Eigen::Vector3i& cell) {
    const Voxel one = a.voxel(center(cell)), two = b.voxel(center(cell));
    ASSERT_EQ(one.state, two.state);
    ASSERT_EQ(one.observed, two.observed);
    ASSERT_EQ(one.log_odds, two.log_odds);
    ASSERT_EQ(labels(a, one), labels(b, two));
  });
}

TEST(Merge, DoesNotDependOnTheOrderOfMapsNorOnHowOftenOneIsMerged) {
  for (unsigned seed = 0; seed < 3; ++seed) {
    const Snapshot a = worlds::random_map(seed, edge).snapshot(), b = other_map(seed + 100);
    const Snapshot c = worlds::random_map(seed + 200, edge).snapshot();
    expect_same(merge(a, b), merge(b, a));
    expect_same(merge(merge(a, b), c), merge(a, merge(b, c)));
    expect_same(merge(merge(c, b), a), merge(merge(a, b), c));
    expect_same(merge(merge(a, b), b), merge(a, b));
    EXPECT_TRUE(merge(a, a).tree() == a.tree());
  }
}

TEST(Merge, OfAMapWithNothingIsTheMap) {
  const Snapshot map = worlds::random_map(3, edge).snapshot();
  FreeSpaceMap nothing({.resolution = edge});
  EXPECT_TRUE(merge(map, nothing.snapshot()).tree() == map.tree());
  EXPECT_FALSE(difference(merge(nothing.snapshot(), map), map).any());
}

TEST(Merge, CountsASphereThatBothHoldOnce) {
  FreeSpaceMap map({.resolution = edge});
  map.add_volume("v", {});
  map.paint(0, {{0, 0, 0}, 0.3});
  map.paint(0, {{0, 0, 0}, 0.3});
  EXPECT_EQ(merge(map.snapshot(), map.snapshot()).volumes()[0].spheres.size(), 2U);
}

TEST(Merge, EachSphereKeepsTheStrokeThatPaintedIt) {
  const auto painted_by = [](const std::string& who, double x) {
    FreeSpaceMap map({.resolution = edge});
    map.add_volume("v", {});
    for (const std::string part : {" first", " second"}) {
      map.begin_stroke(who + part, "hand of " + who);
      map.paint(0, {{x, part == " first" ? 0.0 : 1.0, 0.0}, 0.3}, x);
      map.end_stroke();
    }
    map.paint(0, {{x, 2.0, 0.0}, 0.3}, x);  // in no stroke
    return map.snapshot();
  };
  const Snapshot ann = painted_by("Ann", 1.0), bob = painted_by("Bob", 2.0);
  for (const Snapshot& merged : {merge(ann, bob), merge(bob, ann)}) {
    const PaintedVolume& volume = merged.volumes()[0];
    ASSERT_EQ(volume.spheres.size(), 6U);
    EXPECT_EQ(volume.strokes.size(), 4U);
    for (std::size_t i = 0; i < volume.spheres.size(); ++i) {
      const Eigen::Vector3d& at = volume.spheres[i].center;
      const Stroke* stroke = volume.stroke(i);
      ASSERT_EQ(stroke == nullptr, at.y() == 2.0);
      if (stroke == nullptr) continue;
      const std::string who = at.x() == 1.0 ? "Ann" : "Bob";
      EXPECT_EQ(stroke->label, who + (at.y() == 0.0 ? " first" : " second"));
      EXPECT_EQ(stroke->source, "hand of " + who);
      EXPECT_EQ(stroke->begin, at.x());
      EXPECT_EQ(stroke->end, at.x());
    }
  }
}

TEST(Merge, RefusesWhatDoesNotFit) {
  const Snapshot map = worlds::random_map(4, edge).snapshot();
  EXPECT_THROW(merge(map, FreeSpaceMap({.resolution = 0.1}).snapshot()), std::invalid_argument);
  try {
    merge(map, FreeSpaceMap({.resolution = 0.05000000001}).snapshot());
    ADD_FAILURE() << "other voxels were merged";
  } catch (const std::invalid_argument& error) {
    EXPECT_STREQ(error.what(),
                 "merge: the maps have voxels of 0.05 m and 0.05000000001 m, expected the same");
  }
  EXPECT_THROW(merge(map, FreeSpaceMap({.resolution = edge, .occupied_probability = 0.6}).snapshot()),
               std::invalid_argument);
  FreeSpaceMap parts({.resolution = edge}), many({.resolution = edge});
  parts.add_volume("dock", {"another part"});
  try {
    merge(map, parts.snapshot());
    ADD_FAILURE() << "other parts were merged";
  } catch (const std::invalid_argument& error) {
    EXPECT_STREQ(error.what(),
                 "merge: volume 'dock' has the critical parts base in one map and the critical parts another "
                 "part in the other, expected the same");
  }
  for (int i = 0; i < 14; ++i) many.add_volume(std::to_string(i), {});
  EXPECT_THROW(merge(map, many.snapshot()), std::invalid_argument);
}

TEST(Crop, KeepsTheVoxelsOfTheBoxAndNothingElse) {
  for (unsigned seed = 0; seed < 4; ++seed) {
    Dice dice(seed);
    const Snapshot map = worlds::random_map(seed, edge).snapshot();
    const Eigen::Vector3i low(dice.whole(-15, 0), dice.whole(-15, 0), dice.whole(-15, 0));
    const Eigen::Vector3i high(dice.whole(1, 15), dice.whole(1, 15), dice.whole(1, 15));
    const double inwards = seed % 2 == 0 ? 0.0 : 0.4;  // a box that cuts voxels is snapped outwards
    const Eigen::AlignedBox3d box((low.cast<double>().array() + inwards) * edge,
                                  (high.cast<double>().array() - inwards) * edge);
    const Snapshot part = crop(map, box);
    for_random_cells(30, 10000, [&](const Eigen::Vector3i& cell) {
      const Voxel before = map.voxel(center(cell)), now = part.voxel(center(cell));
      const bool inside = (cell.array() >= low.array()).all() && (cell.array() < high.array()).all();
      ASSERT_EQ(now.state, inside ? before.state : VoxelState::unknown);
      ASSERT_EQ(now.volumes, inside ? before.volumes : 0);
      ASSERT_TRUE(!inside || !before.observed || now.log_odds == before.log_odds);
      for (std::size_t v = 0; v < part.volumes().size(); ++v) {
        ASSERT_TRUE((now.volumes >> v & 1U) == 0 || part.volumes()[v].contains(center(cell)));
      }
    });
    EXPECT_LE(part.volumes()[0].spheres.size(), map.volumes()[0].spheres.size());
  }
}

/// Behind each face of the box, which is snapped outwards to voxels, a ball that touches it and one that does
/// not; and two that the box about them takes across an edge of it. All numbers are exact.
TEST(Crop, KeepsTheBallsThatReachTheSnappedBoxWithTheirTimesAndStrokes) {
  constexpr double voxel = 0.0625, radius = 0.25, inwards = 0.25 * voxel, gap = 0.5 * voxel;
  const Eigen::Vector3d low(-0.5, 0.125, 0.3125), high(0.1875, 0.625, 0.75), middle = (low + high) / 2;
  FreeSpaceMap map({.resolution = voxel});
  map.add_volume("v", {"base"});
  std::vector<std::string> expected;
  double time = 0.0;
  const auto paint = [&](const Eigen::Vector3d& at, const std::string& name, bool is_kept) {
    map.begin_stroke(name, "hand");
    map.paint(0, {at, radius}, time += 1.0);
    map.end_stroke();
    if (is_kept) expected.push_back(name + " at " + std::to_string(time));
  };
  for (int axis = 0; axis < 3; ++axis) {
    for (const double side : {-1.0, 1.0}) {
      Eigen::Vector3d at = middle;
      at[axis] = (side < 0.0 ? low : high)[axis] + side * radius;
      paint(at, "touches", true);
      at[axis] += side * gap;
      paint(at, "beside", false);
    }
  }
  paint(high + Eigen::Vector3d(0.1875, 0.1875, 0.0), "off an edge", false);
  paint(high + Eigen::Vector3d(0.1875, 0.125, 0.0), "at an edge", true);
  map.paint(0, {middle, radius}, time += 1.0);
  expected.push_back(" at " + std::to_string(time));
  const Eigen::Vector3d in = Eigen::Vector3d::Constant(inwards);
  const Snapshot part = crop(map.snapshot(), {low + in, high - in});
  const PaintedVolume& volume = part.volumes()[0];
  EXPECT_EQ(volume.label, "v");
  EXPECT_EQ(volume.critical_parts, std::vector<std::string>{"base"});
  std::vector<std::string> kept;
  for (std::size_t i = 0; i < volume.spheres.size(); ++i) {
    const Stroke* stroke = volume.stroke(i);
    kept.push_back((stroke == nullptr ? "" : stroke->label) + " at " + std::to_string(volume.times[i]));
    EXPECT_EQ(volume.spheres[i].radius, radius);
  }
  EXPECT_EQ(kept, expected);
}

TEST(Crop, RefusesABoxThatIsNone) {
  const Snapshot map = worlds::random_map(4, edge).snapshot();
  EXPECT_THROW(crop(map, {}), std::invalid_argument);
  EXPECT_THROW(crop(map, {Eigen::Vector3d(0, 0, 0), Eigen::Vector3d(1, 0, 1)}), std::invalid_argument);
  EXPECT_THROW(crop(map, {Eigen::Vector3d(0, 0, 0), Eigen::Vector3d(1, HUGE_VAL, 1)}), std::invalid_argument);
}

TEST(Coarsen, SaysOfACoarseVoxelOnlyWhatHoldsForAllOfIt) {
  std::size_t painted = 0, occupied = 0, seen_free = 0;
  for (unsigned seed = 0; seed < 8; ++seed) {
    const int factor = 1 << (1 + seed % 3);
    FreeSpaceMap source = worlds::random_map(seed, edge, 6, 3000);
    source.paint(0, {{0.1, 0.1, 0.1}, 0.5});
    const Snapshot map = source.snapshot();
    const Snapshot coarse = coarsen(map, edge * factor);
    EXPECT_DOUBLE_EQ(coarse.resolution(), edge * factor);
    for_random_cells(32 / factor, 3000 / factor, [&](const Eigen::Vector3i& cell) {
      bool blocked = false, observed = true;
      unsigned mask = 0xffff;
      for (int i = 0; i < factor * factor * factor; ++i) {
        const Eigen::Vector3i step(i % factor, i / factor % factor, i / factor / factor);
        const Voxel voxel = map.voxel(center(cell * factor + step));
        blocked |= voxel.state == VoxelState::occupied || voxel.state == VoxelState::conflict;
        observed &= voxel.observed;
        mask &= voxel.volumes;
      }
      const Voxel now = coarse.voxel(center(cell, edge * factor));
      VoxelState expected = mask != 0 ? VoxelState::painted : VoxelState::unknown;
      if (blocked) expected = mask != 0 ? VoxelState::conflict : VoxelState::occupied;
      if (!blocked && mask == 0 && observed) expected = VoxelState::seen_free;
      ASSERT_EQ(now.state, expected);
      ASSERT_EQ(now.volumes, mask);
      painted += expected == VoxelState::painted ? 1 : 0;
      occupied += expected == VoxelState::occupied ? 1 : 0;
      seen_free += expected == VoxelState::seen_free ? 1 : 0;
    });
  }
  EXPECT_GT(painted, 10U);
  EXPECT_GT(occupied, 10U);
  EXPECT_GT(seen_free, 10U);
}

TEST(Coarsen, KeepsCubesThatOneLeafStandsFor) {
  const auto tree = std::make_shared<FusedTree>(0.01);
  tree->paint(0, {{0.0, 0.0, 0.0}, 1000.0});  // every voxel
  const Snapshot coarse = coarsen({tree, {PaintedVolume{"v", {}}}, nullptr}, 0.04);
  EXPECT_EQ(coarse.counts().painted, std::size_t{1} << 42U);
  EXPECT_EQ(coarse.state({327.0, -327.0, 327.0}), VoxelState::painted);
  EXPECT_EQ(coarse.state({328.0, 0.0, 0.0}), VoxelState::unknown);
}

TEST(Coarsen, RefusesWhatIsNoPowerOfTwo) {
  const Snapshot map = worlds::random_map(4, edge).snapshot();
  for (const double bad : {0.05, 0.15, 0.025, 0.11, 204.8, 0.0, -0.1, std::nan("")})
    EXPECT_THROW(coarsen(map, bad), std::invalid_argument) << bad;
}

}  // namespace map_edit_test
}  // namespace clearway
