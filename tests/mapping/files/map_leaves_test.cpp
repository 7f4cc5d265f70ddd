// Maps gone through leaf by leaf, against the tree that load_map makes of the same file.

#include "mapping/files/map_leaves.hpp"

#include <gtest/gtest.h>

#include <map>
#include <optional>
#include <tuple>

#include "mapping/files/map_digest.hpp"
#include "mapping/files/map_file.hpp"
#include "mapping/files/octree_file.hpp"
#include "mapping/maps/hand_edit.hpp"
#include "mapping/stamps/seen_stamps.hpp"
#include "mapping/system/child_process.hpp"
#include "mapping/voxels/fused_tree.hpp"
#include "tests/worlds/random_map.hpp"
#include "tests/worlds/temporary_folder.hpp"

namespace clearway {
namespace map_leaves_test {

namespace fs = std::filesystem;

/// State and volumes of every voxel of the finest size.
using Voxels = std::map<std::tuple<int, int, int>, std::pair<VoxelState, unsigned>>;

Voxels voxels_of(const MapLeaves& map) {
  Voxels voxels;
  map.visit([&](const MapLeaf& leaf) {
    for (int x = 0; x < leaf.edge; ++x)
      for (int y = 0; y < leaf.edge; ++y)
        for (int z = 0; z < leaf.edge; ++z) {
          const bool is_new = voxels
                                  .insert({{leaf.corner.x() + x, leaf.corner.y() + y, leaf.corner.z() + z},
                                           {leaf.state, leaf.volumes}})
                                  .second;
          EXPECT_TRUE(is_new) << "a voxel came twice";
        }
  });
  return voxels;
}

bool has_observed(const Snapshot& map) {
  bool has = false;
  map.visit_leaves([&](const Voxel& leaf) { has = has || leaf.observed; });
  return has;
}

void expect_same(const MapLeaves& streamed, const Snapshot& loaded) {
  const MapLeaves in_memory(loaded);
  EXPECT_EQ(streamed.resolution(), loaded.resolution());
  EXPECT_EQ(voxels_of(streamed), voxels_of(in_memory));
  std::size_t observed = 0;
  streamed.visit([&](const MapLeaf& leaf) {
    const Eigen::Vector3d middle =
        (leaf.corner.cast<double>().array() + 0.5 * leaf.edge) * loaded.resolution();
    const Voxel voxel = loaded.voxel(middle);
    ASSERT_EQ(leaf.observed, voxel.observed);
    if (leaf.observed) {
      ASSERT_EQ(static_cast<double>(leaf.log_odds), voxel.log_odds);
    }
    observed += leaf.observed;
  });
  EXPECT_EQ(observed > 0, has_observed(loaded));
  const VoxelCounts a = streamed.counts(), b = loaded.counts();
  EXPECT_EQ(std::tuple(a.painted, a.seen_free, a.occupied, a.conflict),
            std::tuple(b.painted, b.seen_free, b.occupied, b.conflict));
  EXPECT_EQ(streamed.bounds().isEmpty(), loaded.bounds().isEmpty());
  if (!loaded.bounds().isEmpty()) {
    EXPECT_EQ(streamed.bounds().min(), loaded.bounds().min());
    EXPECT_EQ(streamed.bounds().max(), loaded.bounds().max());
  }
  ASSERT_EQ(streamed.volumes().size(), loaded.volumes().size());
  for (std::size_t v = 0; v < loaded.volumes().size(); ++v) {
    EXPECT_EQ(streamed.volumes()[v].label, loaded.volumes()[v].label);
    EXPECT_EQ(streamed.volumes()[v].spheres.size(), loaded.volumes()[v].spheres.size());
  }
  EXPECT_EQ(streamed.about().tree().integration(), loaded.tree().integration());
  EXPECT_EQ(streamed.about().seen() == nullptr, loaded.seen() == nullptr);
}

TEST(MapLeaves, OfOurFilesAreThoseOfTheTreeInItsOrder) {
  const TemporaryFolder folder;
  for (unsigned seed = 0; seed < 12; ++seed) {
    FreeSpaceMap made = worlds::random_map(seed);
    worlds::Dice dice(seed);
    Scan timed = worlds::random_scan(dice, 300);
    timed.time = 12.5;
    if (seed % 2 == 0) made.insert(timed);
    save_map(made.snapshot(), folder / "map");
    const Snapshot loaded = load_map(folder / "map");
    const MapLeaves streamed = MapLeaves::in_file(folder / "map");
    expect_same(streamed, loaded);
    EXPECT_EQ(streamed.sha256(), map_sha256(folder / "map"));
    EXPECT_EQ(streamed.tree_bytes(), loaded.tree().memoryUsage());
    if (loaded.seen() != nullptr) {
      EXPECT_EQ(streamed.about().seen()->newest(), loaded.seen()->newest());
      loaded.visit_leaves([&](const Voxel& leaf) {
        EXPECT_EQ(streamed.about().last_seen(leaf.center), loaded.last_seen(leaf.center));
      });
    }
    std::vector<std::uint64_t> order[2];
    for (const bool stream : {false, true})
      (stream ? streamed : MapLeaves(loaded)).visit([&](const MapLeaf& leaf) {
        order[stream].push_back(static_cast<std::uint64_t>(leaf.corner.x() + 32768) << 40U |
                                static_cast<std::uint64_t>(leaf.corner.y() + 32768) << 20U |
                                static_cast<std::uint64_t>(leaf.corner.z() + 32768));
      });
    EXPECT_EQ(order[0], order[1]);
  }
}

TEST(MapLeaves, OfOtherProgramsFilesAndOfCloudsAreThoseOfLoadMap) {
  const TemporaryFolder folder;
  for (unsigned seed = 20; seed < 24; ++seed) {
    const Snapshot map = worlds::random_map(seed).snapshot();
    for (const char* name : {"colour.ot", "binary.bt", "cloud.pcd"}) {
      export_map(map, folder / name);
      expect_same(MapLeaves::in_file(folder / name), load_map(folder / name));
    }
  }
}

/// A .bt of OctoMap before 1.0 has a header of numbers: no text ends it.
TEST(MapLeaves, OfBinaryFilesOfBeforeOneAreThoseOfLoadMap) {
  const TemporaryFolder folder;
  const Snapshot map = worlds::random_map(25).snapshot();
  export_map(map, folder / "new.bt");
  const std::string bytes = read_file(folder / "new.bt");
  const auto word = [](const auto& number) {
    return std::string(reinterpret_cast<const char*>(&number), sizeof(number));
  };
  const std::size_t size = bytes.find("\nsize ") + 6;
  const auto nodes = static_cast<std::uint32_t>(std::stoul(bytes.substr(size)));
  const auto old = folder.write("old.bt", word(std::int32_t{3}) + word(map.resolution()) + word(nodes) +
                                              bytes.substr(bytes.find("\ndata\n") + 6));
  expect_same(MapLeaves::in_file(old), load_map(folder / "new.bt"));
}

TEST(MapLeaves, OfAnEmptyMapAreNone) {
  const TemporaryFolder folder;
  save_map(FreeSpaceMap({.resolution = 0.1}).snapshot(), folder / "map");
  expect_same(MapLeaves::in_file(folder / "map"), load_map(folder / "map"));
}

std::string complaint(const std::function<void()>& read) {
  try {
    read();
  } catch (const DamagedFile& error) {
    return error.what();
  }
  return "";
}

void visit_all(const fs::path& file) {
  MapLeaves::in_file(file).visit([](const MapLeaf&) {});
}

/// Cut off, or with a bit turned over, anywhere: the same sentence as load_map's.
TEST(MapLeaves, OfDamagedFilesAreRefusedAsLoadMapRefusesThem) {
  const TemporaryFolder folder;
  worlds::Dice dice(3);
  const Snapshot map = worlds::random_map(3).snapshot();
  save_map(map, folder / "map");
  export_map(map, folder / "colour.ot");
  export_map(map, folder / "binary.bt");
  for (const fs::path& file : {folder / "map" / "map.ot", folder / "colour.ot", folder / "binary.bt"}) {
    const std::string whole = read_file(file);
    std::size_t refused = 0;
    for (int round = 0; round < 300; ++round) {
      std::string bytes = whole;
      const auto at = static_cast<std::size_t>(dice.whole(0, static_cast<int>(bytes.size()) - 1));
      if (round % 3 == 0)
        bytes.resize(at);
      else if (round % 3 == 1)
        bytes[at] = static_cast<char>(bytes[at] ^ 1 << dice.whole(0, 7));
      else
        bytes += "more";
      const fs::path damaged = folder / ("damaged" + file.extension().string());
      folder.write(damaged.filename().string(), bytes);
      const std::string sentence = complaint([&] { load_map(damaged); });
      EXPECT_EQ(complaint([&] { visit_all(damaged); }), sentence);
      refused += !sentence.empty();
    }
    EXPECT_GT(refused, 100U) << file;
  }
}

// What a sanitizer keeps about memory is no cost of the reader.
#if defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__)
constexpr bool memory_is_measured = false;
#else
constexpr bool memory_is_measured = true;
#endif

/// The file of a map of 1.1 million nodes.
std::string large_map() {
  auto tree = std::make_shared<FusedTree>(0.01);
  worlds::Dice dice(5);
  for (int x = -50; x < 50; ++x)
    for (int y = -50; y < 50; ++y)
      for (int z = -50; z < 50; ++z)
        tree->set_observed(
            {static_cast<octomap::key_type>(32768 + x), static_cast<octomap::key_type>(32768 + y),
             static_cast<octomap::key_type>(32768 + z)},
            static_cast<float>(dice.uniform(-2.0, 2.0)));
  tree->finish();
  return format_fused_tree(*tree, {});
}

/// The file alone has more than the process may still allocate.
TEST(MapLeaves, OfAFileTakeNoMemoryThatGrowsWithIt) {
  if (!memory_is_measured) GTEST_SKIP();
  const TemporaryFolder folder;
  const auto result = [](const std::function<std::string()>& step, std::size_t memory) {
    const ChildOutcome outcome =
        run_in_child(step, {.memory = memory, .output = std::size_t{20} << 20U, .seconds = 60});
    EXPECT_TRUE(outcome.finished) << outcome.failure;
    return outcome.finished ? outcome.parts.at(0) : std::string();
  };
  folder.write("map.ot", result(large_map, std::size_t{4} << 30U));
  ASSERT_GT(fs::file_size(folder / "map.ot"), 8'000'000U);
  const auto count = [&] {
    const VoxelCounts counts = MapLeaves::in_file(folder / "map.ot").counts();
    return std::to_string(counts.occupied + counts.seen_free);
  };
  EXPECT_EQ(result(count, std::size_t{4} << 20U), "1000000");
}

constexpr double cell = 0.1;  ///< m

/// Voxels of a box of cells, low to high - 1.
std::vector<Eigen::Vector3d> box(const Eigen::Vector3i& low, const Eigen::Vector3i& high) {
  std::vector<Eigen::Vector3d> points;
  for (int x = low.x(); x < high.x(); ++x)
    for (int y = low.y(); y < high.y(); ++y)
      for (int z = low.z(); z < high.z(); ++z)
        points.emplace_back(cell * Eigen::Vector3d(x + 0.5, y + 0.5, z + 0.5));
  return points;
}

Snapshot occupied_at(const Snapshot& map, const std::vector<Eigen::Vector3d>& points) {
  HandEditTally tally;
  return with_occupied_voxels(map, points, tally);
}

Snapshot free_at(const Snapshot& map, const std::vector<Eigen::Vector3d>& points) {
  HandEditTally tally;
  return with_cleared_voxels(map, points, tally);
}

/// A floor of 4 m and a ceiling.
Snapshot room() {
  const Snapshot floor =
      occupied_at(FreeSpaceMap({.resolution = cell}).snapshot(), box({-20, -20, 0}, {20, 20, 1}));
  return occupied_at(floor, box({-20, -20, 25}, {20, 20, 26}));
}

TEST(MapLeaves, AFewFarReturnsAreNoPartOfTheMainBounds) {
  const MapLeaves plain(room()), far(occupied_at(room(), box({600, 0, 0}, {601, 1, 3}))),
      near(occupied_at(room(), box({50, 0, 0}, {51, 1, 3}))),
      many(occupied_at(room(), box({600, 0, 0}, {602, 10, 10})));
  EXPECT_TRUE(plain.main_bounds().isApprox(plain.bounds()));
  EXPECT_TRUE(near.main_bounds().isApprox(near.bounds())) << "no farther from the rest than that is long";
  EXPECT_TRUE(many.main_bounds().isApprox(many.bounds())) << "one voxel in 17 is not few";
  const Eigen::AlignedBox3d main = far.main_bounds();
  EXPECT_GT(far.bounds().max().x(), 60.0);
  EXPECT_TRUE(main.contains(plain.bounds()));
  EXPECT_LT(main.max().x(), 5.0);
  EXPECT_EQ(main.min(), far.bounds().min());
  EXPECT_TRUE(MapLeaves(FreeSpaceMap({.resolution = cell}).snapshot()).main_bounds().isEmpty());
}

TEST(MapLeaves, TheFewFreeVoxelsOnTheWayToAFarReturnAreNoPartOfTheMainBounds) {
  const Snapshot seen = free_at(room(), box({-60, -20, 1}, {20, 20, 25}));
  const MapLeaves near(seen),
      far(free_at(occupied_at(seen, box({600, 0, 5}, {601, 1, 6})), box({20, 0, 5}, {600, 1, 6})));
  EXPECT_TRUE(near.main_bounds().isApprox(near.bounds()));
  EXPECT_LT(far.main_bounds().max().x(), 5.0);
  EXPECT_TRUE(far.main_bounds().contains(near.bounds()));
  const MapLeaves only_free(
      free_at(free_at(FreeSpaceMap({.resolution = cell}).snapshot(), box({-20, -20, 1}, {20, 20, 25})),
              box({20, 0, 5}, {600, 1, 6})));
  EXPECT_LT(only_free.main_bounds().max().x(), 5.0);
}

TEST(MapLeaves, WhatIsPaintedOrInConflictIsPartOfTheMainBoundsHoweverFarAway) {
  FreeSpaceMap map({.resolution = cell});
  map.paint(map.add_volume("niche", {}), {Eigen::Vector3d(60.05, 0.05, 0.05), 0.25}, 0.0);
  const Snapshot with_room = occupied_at(occupied_at(map.snapshot(), box({-20, -20, 0}, {20, 20, 1})),
                                         box({-20, -20, 25}, {20, 20, 26}));
  const MapLeaves painted(with_room), conflict(occupied_at(with_room, box({600, 0, 0}, {601, 1, 1})));
  EXPECT_EQ(conflict.counts().conflict, 1U);
  EXPECT_TRUE(painted.main_bounds().isApprox(painted.bounds()));
  EXPECT_TRUE(conflict.main_bounds().isApprox(conflict.bounds()));
}

TEST(MapLeaves, WhatStandsOrHangsOverALargeFloorIsPartOfTheMainBounds) {
  const Snapshot floor =
      occupied_at(FreeSpaceMap({.resolution = cell}).snapshot(), box({-150, -150, 0}, {150, 150, 1}));
  for (const auto& [low, high] : {std::pair(1, 120), std::pair(118, 120)}) {
    const MapLeaves leaves(occupied_at(floor, box({0, 0, low}, {1, 1, high})));
    EXPECT_EQ(leaves.main_bounds().max().z(), leaves.bounds().max().z());
  }
}

}  // namespace map_leaves_test
}  // namespace clearway
