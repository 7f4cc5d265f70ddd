#include "mapping/maps/suspect_paint.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <set>

#include "mapping/free_space_map.hpp"
#include "tests/worlds/random_map.hpp"

namespace clearway {
namespace suspect_paint_test {

constexpr double resolution = 0.05;

/// Every voxel of a box asked by itself, every sphere looked through.
std::size_t counted(const Snapshot& map, std::set<std::string>& strokes) {
  std::vector<Eigen::Vector3d> conflicts, unseen;
  constexpr int far = 60;
  for (int x = -far; x < far; ++x)
    for (int y = -far; y < far; ++y)
      for (int z = -far; z < far; ++z) {
        const Eigen::Vector3d at = resolution * Eigen::Vector3d(x + 0.5, y + 0.5, z + 0.5);
        const Voxel voxel = map.voxel(at);
        if (voxel.state == VoxelState::conflict) conflicts.push_back(at);
        if (voxel.state == VoxelState::painted && !voxel.observed) unseen.push_back(at);
      }
  const auto holds = [](const Sphere& sphere, const Eigen::Vector3d& at) {
    return (at - sphere.center).norm() <= sphere.radius;
  };
  std::set<std::size_t> suspect;
  for (const PaintedVolume& volume : map.volumes())
    for (std::size_t i = 0; i < volume.spheres.size(); ++i) {
      const Sphere& sphere = volume.spheres[i];
      if (std::none_of(conflicts.begin(), conflicts.end(), [&](const auto& at) { return holds(sphere, at); }))
        continue;
      for (std::size_t k = 0; k < unseen.size(); ++k)
        if (holds(sphere, unseen[k])) suspect.insert(k), strokes.insert(volume.stroke(i)->label);
    }
  return suspect.size();
}

TEST(SuspectPaint, IsWhatNobodySawInBallsThatHoldAConflict) {
  std::size_t found = 0, none = 0;
  for (unsigned seed = 0; seed < 8; ++seed) {
    worlds::Dice dice(seed);
    FreeSpaceMap map({.resolution = resolution});
    for (const char* label : {"a", "b"}) map.add_volume(label, {});
    for (int step = 0; step < 12; ++step) {
      if (dice.whole(0, 2) == 0) {
        Scan scan = worlds::random_scan(dice, 150);
        scan.time = 0.5 * step;
        map.insert(scan);
      } else {
        map.begin_stroke("stroke " + std::to_string(step));
        map.paint(dice.whole(0, 1), worlds::random_sphere(dice), 0.5 * step);
      }
    }
    std::set<std::string> strokes;
    const std::size_t expected = counted(map.snapshot(), strokes);
    const SuspectPaint suspect = suspect_paint(map.snapshot());
    EXPECT_EQ(suspect.voxels, expected) << seed;
    EXPECT_EQ(suspect.strokes.empty(), expected == 0) << seed;
    for (const std::string& stroke : suspect.strokes) EXPECT_TRUE(strokes.contains(stroke)) << seed;
    EXPECT_EQ(suspect_paint_caveat(map.snapshot()).empty(), expected == 0) << seed;
    (expected > 0 ? found : none) += 1;
  }
  EXPECT_GT(found, 3U);
}

/// A wall that a camera before it sees, and a ball that is led through it and on.
TEST(SuspectPaint, TellsOfAStrokeThroughAWallAndNotOfOneBeforeIt) {
  const auto caveat_of = [](double to) {
    FreeSpaceMap map({.resolution = 0.02});
    Scan scan;
    for (int y = -40; y <= 40; ++y)
      for (int z = -40; z <= 40; ++z)
        scan.points.emplace_back(1.0f, 0.01f * static_cast<float>(y), 0.01f * static_cast<float>(z));
    for (int i = 0; i < 3; ++i) scan.time = 0.1 * i, map.insert(scan);
    map.add_volume("free", {});
    map.begin_stroke("stroke at 3 s");
    for (double x = 0.4; x <= to; x += 0.01) map.paint(0, {{x, 0.0, 0.0}, 0.1}, 3.0);
    return suspect_paint_caveat(map.snapshot());
  };
  EXPECT_EQ(caveat_of(0.85), "");
  const std::string through = caveat_of(1.3);
  EXPECT_NE(through.find("painted voxels that no scan has looked at lie in balls"), std::string::npos)
      << through;
  EXPECT_NE(through.find("of 'stroke at 3 s'"), std::string::npos) << through;
}

}  // namespace suspect_paint_test
}  // namespace clearway
