#include "mapping/voxels/memory_room.hpp"

#include <gtest/gtest.h>
#include <malloc.h>
#include <sys/resource.h>
#include <unistd.h>

#include <bit>
#include <cstdlib>
#include <fstream>
#include <regex>
#include <string>

#include "mapping/scans/scan_rays.hpp"
#include "mapping/system/child_process.hpp"
#include "mapping/voxels/sanitizers.hpp"
#include "tests/worlds/random_map.hpp"

namespace clearway {
namespace memory_room_test {

// What a sanitizer keeps about memory counts as the process's own.
constexpr bool memory_is_measured = !address_sanitized && !thread_sanitized;

TEST(MemoryRoom, SaysWhatIsNeededAndWhatThereIs) {
  require_memory(1000, "three numbers");
  try {
    require_memory(std::uint64_t{5} << 60U, "the stars");
    FAIL();
  } catch (const std::runtime_error& error) {
    EXPECT_EQ(std::string(error.what()).rfind("the stars need some 5.765e+09 GB", 0), 0U) << error.what();
    EXPECT_NE(std::string(error.what()).find("choose coarser voxels"), std::string::npos);
  }
}

TEST(MemoryRoom, IsNoMoreThanTheMachineHasAndThanTheProcessMayTake) {
  std::ifstream file("/proc/meminfo");
  std::string name;
  std::uint64_t kibibytes = 0;
  ASSERT_TRUE(file >> name >> kibibytes);
  ASSERT_EQ(name, "MemTotal:");
  EXPECT_LE(available_memory(), 1024 * kibibytes);
  EXPECT_GT(available_memory(), std::uint64_t{1} << 20U);
  if (!memory_is_measured) return;
  const ChildOutcome outcome =
      run_in_child([] { return std::to_string(available_memory()); }, {std::size_t{300} << 20U, 100, 10});
  ASSERT_TRUE(outcome.finished) << outcome.failure;
  EXPECT_LE(std::stoull(outcome.parts.at(0)), std::uint64_t{300} << 20U);
  EXPECT_GT(std::stoull(outcome.parts.at(0)), std::uint64_t{200} << 20U);
}

/// Rays of this length (metres) to all sides, no two of them near each other at their ends.
Scan star(std::size_t rays, double length) {
  worlds::Dice dice(3);
  Scan scan;
  for (std::size_t i = 0; i < rays; ++i)
    scan.points.push_back((length * dice.point(1.0).normalized()).cast<float>());
  return scan;
}

TEST(MemoryRoom, WhatATreeNeedsForAScanIsReckonedBefore) {
  for (const double resolution : {0.02, 0.005}) {
    FusedTree tree(resolution);
    ScanWorkspace workspace;
    const std::size_t before = tree.memoryUsage();
    insert_scan(tree, star(1000, 2.0), {}, {}, workspace);
    const std::size_t grown = tree.memoryUsage() - before;
    EXPECT_GE(workspace.grid.tree_bytes(), grown) << resolution;
    EXPECT_LE(workspace.grid.tree_bytes(), 2 * grown) << resolution;
  }
}

/// The same into one octant.
Scan octant(std::size_t rays, double length) {
  Scan scan = star(rays, length);
  for (Eigen::Vector3f& point : scan.points) point = point.cwiseAbs();
  return scan;
}

/// Takes what the tests before left free on the heap, which no limit of addresses counts.
void take_free_heap() {
  for (const std::size_t chunk : {std::size_t{1} << 16U, std::size_t{1} << 12U})
    for (const std::size_t size = mallinfo2().arena; mallinfo2().arena == size;) {
      void* volatile taken = std::malloc(chunk);  // the process ends soon
      if (taken == nullptr) return;
    }
}

/// Limits this process to so many more bytes. The limit before.
rlimit leave_addresses(std::size_t bytes) {
  rlimit before{};
  getrlimit(RLIMIT_AS, &before);
  std::ifstream statm("/proc/self/statm");
  std::size_t pages = 0;
  statm >> pages;
  const rlimit now{pages * static_cast<std::size_t>(sysconf(_SC_PAGESIZE)) + bytes, before.rlim_max};
  setrlimit(RLIMIT_AS, &now);
  return before;
}

std::size_t free_cells(ScanGrid& grid) {
  std::size_t count = 0;
  for (const ScanTile* tile : grid.tiles())
    for (const std::uint64_t word : tile->free) count += static_cast<std::size_t>(std::popcount(word));
  return count;
}

/// Thousands of tiles, from windows over an eighth of the rays each that are read whole. What the last window
/// still holds when memory ends would be free in the next scan.
TEST(MemoryRoom, AScanThatNeedsMoreIsRefusedInASentenceAndLeavesNoTrace) {
  if (!memory_is_measured) GTEST_SKIP();
  const auto work = [&]() -> std::string {
    FusedTree tree(1e-4);
    ScanWorkspace workspace, fresh;
    const ScanInsertion insertion;
    insert_scan(tree, star(100, 0.0445), {}, insertion, workspace);  // takes the windows' memory
    const std::size_t nodes = tree.size();
    take_free_heap();
    const rlimit before = leave_addresses(std::size_t{100} << 20U);
    std::string said = "not refused";
    try {
      insert_scan(tree, star(250000, 0.0445), {}, insertion, workspace);
    } catch (const std::runtime_error& error) {
      said = error.what();
    }
    setrlimit(RLIMIT_AS, &before);
    if (tree.size() != nodes) said += "; changed the tree";
    const Scan next = octant(31000, 0.044);
    for (ScanWorkspace* used : {&workspace, &fresh}) {
      ScanCounts counts;
      cast_rays(choose_rays(tree, next, {}, insertion, *used, counts), 1e-4, 1, insertion.instructions,
                used->rays, used->grid);
    }
    if (free_cells(workspace.grid) != free_cells(fresh.grid)) said += "; changed the next scan";
    return said;
  };
  const ChildOutcome outcome = run_in_child(work, {std::size_t{4} << 30U, 10000, 60});
  ASSERT_TRUE(outcome.finished) << outcome.failure;
  std::smatch found;  // what is needed, which is more than what is there
  ASSERT_TRUE(
      std::regex_search(outcome.parts.at(0), found,
                        std::regex("^the voxels of a scan need some (\\d+) MB, and (\\d+) MB are available")))
      << outcome.parts.at(0);
  EXPECT_GT(std::stoi(found[1]), 15);
  EXPECT_GT(std::stoi(found[2]), 15);  // and others are left some
  EXPECT_EQ(outcome.parts.at(0).find(';'), std::string::npos) << outcome.parts.at(0);
}

}  // namespace memory_room_test
}  // namespace clearway
