#include "mapping/latest_snapshot.hpp"

#include <gtest/gtest.h>

#include <atomic>
#include <chrono>
#include <thread>

#include "mapping/voxels/fused_tree.hpp"
#include "tests/worlds/random_map.hpp"

namespace clearway {
namespace latest_snapshot_test {

using worlds::Dice;

constexpr int frames = 25;

FreeSpaceMap empty_map() {
  FreeSpaceMap map({.resolution = 0.04});
  map.add_volume("v", {});
  return map;
}

/// Frame i of the same life of a map, whoever writes it.
void write_frame(FreeSpaceMap& map, Dice& dice) {
  map.insert(worlds::random_scan(dice, 300));
  map.paint(0, worlds::random_sphere(dice));
}

std::array<std::size_t, 5> figures(const Snapshot& map) {
  const VoxelCounts counts = map.counts();
  return {counts.painted, counts.seen_free, counts.occupied, counts.conflict, map.tree().size()};
}

TEST(LatestSnapshot, FourReadersSeeWholeFramesInOrderWhileAWriterAddsThirtyASecond) {
  std::vector<std::array<std::size_t, 5>> expected;
  {
    FreeSpaceMap map = empty_map();
    Dice dice(5);
    for (int i = 0; i < frames; ++i) {
      write_frame(map, dice);
      expected.push_back(figures(map.snapshot()));
    }
  }
  LatestSnapshot latest;
  std::atomic<bool> done = false;
  std::atomic<int> wrong = 0, looks = 0;
  std::vector<std::thread> readers;
  for (int r = 0; r < 4; ++r) {
    readers.emplace_back([&, r] {
      Dice dice(static_cast<unsigned>(r));
      std::size_t seen = 0;
      while (!done) {
        const std::shared_ptr<const Snapshot> map = latest.get();
        if (map->volumes().empty()) continue;
        const auto& spheres = map->volumes().front().spheres;
        if (spheres.size() < seen || figures(*map) != expected[spheres.size() - 1]) ++wrong;
        const VoxelState state = map->state(spheres.back().center);
        if (state != VoxelState::painted && state != VoxelState::conflict) ++wrong;
        const Eigen::AlignedBox3d box(Eigen::Vector3d::Constant(-0.4), Eigen::Vector3d::Constant(0.4));
        const auto space = map->blocked_space({Policy::known_free}, box, 0.2);
        const Eigen::Vector3d point = dice.point(0.39);
        if (space->is_blocked(point) != !allows({Policy::known_free}, map->state(point), 0)) ++wrong;
        seen = spheres.size();
        ++looks;
      }
    });
  }
  FreeSpaceMap map = empty_map();
  Dice dice(5);
  auto next = std::chrono::steady_clock::now();
  for (int i = 0; i < frames; ++i) {
    write_frame(map, dice);
    latest.publish(map.snapshot());
    next += std::chrono::milliseconds(33);
    std::this_thread::sleep_until(next);
  }
  done = true;
  for (std::thread& reader : readers) reader.join();
  EXPECT_EQ(wrong, 0);
  EXPECT_GT(looks, 4);
  EXPECT_EQ(figures(*latest.get()), expected.back());
}

TEST(LatestSnapshot, AReaderMayKeepAnOldOne) {
  LatestSnapshot latest;
  EXPECT_TRUE(latest.get()->bounds().isEmpty());
  FreeSpaceMap map = empty_map();
  Dice dice(2);
  write_frame(map, dice);
  latest.publish(map.snapshot());
  const std::shared_ptr<const Snapshot> kept = latest.get();
  const auto before = figures(*kept);
  for (int i = 0; i < 5; ++i) {
    write_frame(map, dice);
    latest.publish(map.snapshot());
  }
  EXPECT_EQ(figures(*kept), before);
  EXPECT_NE(figures(*latest.get()), before);
}

}  // namespace latest_snapshot_test
}  // namespace clearway
