// What a hostile OctoMap file may cost.

#include "mapping/files/octree_reader.hpp"

#include <gtest/gtest.h>
#include <sys/resource.h>

#include <cstring>

#include "mapping/files/map_file.hpp"
#include "mapping/files/octree_file.hpp"
#include "mapping/system/child_process.hpp"
#include "mapping/voxels/fused_tree.hpp"

namespace clearway {
namespace octree_reader_test {

std::string file_of(bool binary, const std::string& size, const std::string& data) {
  return std::string(binary ? "# Octomap OcTree binary file" : "# Octomap OcTree file") +
         "\nid OcTree\nsize " + size + "\nres 0.1\ndata\n" + data;
}

// What a sanitizer keeps about memory is no cost of the reader.
#if defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__)
constexpr bool memory_is_measured = false;
#else
constexpr bool memory_is_measured = true;
#endif

/// Zero where memory is not measured.
long most_memory_kib() {
  if (!memory_is_measured) return 0;
  rusage usage{};
  getrusage(RUSAGE_SELF, &usage);
  return usage.ru_maxrss;
}

struct Cost {
  bool accepted = false;
  double bytes = 0.0;  ///< of memory beyond what was in use
};

/// Reads the file in a child process, and what that took at most.
Cost read_in_child(const std::string& file) {
  const ChildOutcome outcome = run_in_child(
      [&] {
        const long before = most_memory_kib();
        bool accepted = true;
        try {
          parse_octree(file, "hostile.ot");
        } catch (const DamagedFile&) {
          accepted = false;
        }
        return std::to_string(accepted) + " " + std::to_string(most_memory_kib() - before);
      },
      {.memory = std::size_t{4} << 30U, .output = 1000, .seconds = 60});
  EXPECT_TRUE(outcome.finished) << outcome.failure;
  return {outcome.parts.at(0).front() == '1', 1024.0 * std::stod(outcome.parts.at(0).substr(2))};
}

/// A .ot node and the mask of its children.
std::string node(float log_odds, unsigned char children) {
  std::string bytes(sizeof(log_odds), '\0');
  std::memcpy(bytes.data(), &log_odds, sizeof(log_odds));
  return bytes + static_cast<char>(children);
}

/// Levels that split eightfold, then chains of one child each: the most memory a byte of file can ask for.
std::string chains(int level, int wide, std::size_t& nodes) {
  ++nodes;
  if (level == 16) return node(0.001F * static_cast<float>(nodes % 1000), 0);
  std::string bytes = node(0.0F, level < wide ? 255 : 1);
  for (int child = 0; child < (level < wide ? 8 : 1); ++child) bytes += chains(level + 1, wide, nodes);
  return bytes;
}

/// Full inner nodes whose leaves differ, so that nothing is pruned.
std::string full_binary(int level, std::size_t& nodes) {
  nodes += 8;
  if (level == 0) return "\x59\x66";
  std::string bytes = "\xff\xff";
  for (int child = 0; child < 8; ++child) bytes += full_binary(level - 1, nodes);
  return bytes;
}

TEST(OctreeReader, AHeaderThatPromisesTooMuchCostsNothing) {
  for (const bool binary : {false, true}) {
    for (const char* size : {"99999999999", "18446744073709551615"}) {
      const Cost cost = read_in_child(file_of(binary, size, std::string("\1\0\0\0\0\0\0", 7)));
      EXPECT_FALSE(cost.accepted);
      EXPECT_LT(cost.bytes, 4e6);
    }
  }
}

TEST(OctreeReader, TheDensestTextTreeTakesAtMostTwentyTimesItsFile) {
  std::size_t nodes = 0;
  const std::string data = chains(0, 6, nodes);
  const std::string file = file_of(false, std::to_string(nodes), data);
  ASSERT_GT(file.size(), 10'000'000U);
  const Cost cost = read_in_child(file);
  EXPECT_TRUE(cost.accepted);
  EXPECT_LT(cost.bytes, 20.0 * static_cast<double>(file.size()) + 4e6);
}

TEST(OctreeReader, TheDensestBinaryTreeTakesAtMostAHundredAndTwentyTimesItsFile) {
  std::size_t nodes = 1;
  const std::string data = full_binary(6, nodes);
  const std::string file = file_of(true, std::to_string(nodes), data);
  ASSERT_GT(file.size(), 500'000U);
  const Cost cost = read_in_child(file);
  EXPECT_TRUE(cost.accepted);
  EXPECT_LT(cost.bytes, 120.0 * static_cast<double>(file.size()) + 4e6);
}

TEST(OctreeReader, InnerNodesAreWorkedOutAndForeignTreesPruned) {
  const std::string equal = node(9.0F, 255) + node(0.5F, 0) + node(0.5F, 0) + node(0.5F, 0) + node(0.5F, 0) +
                            node(0.5F, 0) + node(0.5F, 0) + node(0.5F, 0) + node(0.5F, 0);
  const auto pruned = parse_octree(file_of(false, "9", equal), "a.ot").tree;
  EXPECT_EQ(pruned->size(), 1U);
  EXPECT_EQ(pruned->getRoot()->getLogOdds(), 0.5F);
  const std::string two = node(9.0F, 129) + node(-1.0F, 0) + node(0.25F, 0);
  const auto kept = parse_octree(file_of(false, "3", two), "a.ot").tree;
  EXPECT_EQ(kept->size(), 3U);
  EXPECT_EQ(kept->getRoot()->getLogOdds(), 0.25F);
  EXPECT_EQ(kept->getRoot()->child(7)->getLogOdds(), 0.25F);
}

}  // namespace octree_reader_test
}  // namespace clearway
