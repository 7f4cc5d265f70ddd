#include "mapping/stamps/seen_stamps.hpp"

#include <gtest/gtest.h>
#include <sys/resource.h>
#include <unistd.h>

#include <cmath>
#include <cstdlib>
#include <fstream>
#include <limits>
#include <map>
#include <new>
#include <string>
#include <tuple>

#include "mapping/files/map_file.hpp"
#include "mapping/system/child_process.hpp"
#include "mapping/voxels/fused_tree.hpp"
#include "mapping/voxels/sanitizers.hpp"
#include "mapping/voxels/scan_grid.hpp"
#include "tests/worlds/random_map.hpp"

namespace clearway {
namespace seen_stamps_test {

using worlds::Dice;
using Cell = std::tuple<int, int, int>;
using Truth = std::map<Cell, double>;  ///< when each cell was last seen

Eigen::Vector3i vector_of(const Cell& cell) {
  return {std::get<0>(cell), std::get<1>(cell), std::get<2>(cell)};
}

/// A scan that touches some boxes of cells, whole blocks and single cells among them.
void random_look(Dice& dice, int reach, ScanGrid& grid, Truth& truth, double time) {
  grid.clear();
  for (int box = 0; box < 4; ++box) {
    Eigen::Vector3i low(dice.whole(-reach, reach), dice.whole(-reach, reach), dice.whole(-reach, reach));
    if (box == 0) low = low.unaryExpr([](int value) { return value & ~7; });
    const int edge = box == 0 ? 16 : dice.whole(1, 9);
    for (int i = 0; i < edge * edge * edge; ++i) {
      const Eigen::Vector3i cell = low + Eigen::Vector3i(i % edge, i / edge % edge, i / edge / edge);
      if (box == 3 && dice.whole(0, 3) == 0) {
        grid.set_occupied(cell);
      } else {
        grid.set_free(cell);
      }
      double& last = truth.try_emplace({cell.x(), cell.y(), cell.z()}, time).first->second;
      last = std::max(last, time);
    }
  }
}

void expect_true(const SeenStamps& seen, const Truth& truth) {
  for (const auto& [cell, time] : truth) {
    const auto last = seen.last_seen(vector_of(cell));
    ASSERT_TRUE(last.has_value());
    ASSERT_LE(*last, time);
    ASSERT_GT(*last, time - seen.period());
  }
  ASSERT_EQ(seen.voxels(), truth.size());
}

TEST(SeenStamps, EveryVoxelKnowsWhenItWasLastSeenInScansOfAnyOrder) {
  Dice dice(1);
  for (const double start : {0.0, -3.0, 1.7e9}) {
    SeenStamps seen;
    ScanGrid grid;
    Truth truth;
    double newest = -1e300;
    for (int scan = 0; scan < 60; ++scan) {
      const double time = start + 0.4 * scan - dice.uniform(0.0, 3.0);
      random_look(dice, 40, grid, truth, time);
      seen.see(grid, time, dice.whole(1, 4));
      newest = std::max(newest, time);
    }
    EXPECT_EQ(seen.newest(), newest);
    EXPECT_EQ(seen.period(), 1.0 / 64);
    expect_true(seen, truth);
    double oldest = newest;
    for (const auto& [cell, time] : truth) oldest = std::min(oldest, time);
    EXPECT_LE(seen.oldest(), oldest);
    EXPECT_GT(seen.oldest(), oldest - seen.period());
  }
}

TEST(SeenStamps, PeriodsGrowWithTheTimeThatTheyMustSpan) {
  Dice dice(2);
  SeenStamps seen;
  ScanGrid grid;
  Truth truth;
  const std::vector<double> times = {100.0, 101.0, 1123.9, 1124.1, 5000.0, 90.0,
                                     -2e4,  1e6,   1.7e9,  0.0,    1e12,   -1e12};
  double low = times[0], high = times[0];
  for (const double time : times) {
    random_look(dice, 20, grid, truth, time);
    seen.see(grid, time);
    low = std::min(low, time), high = std::max(high, time);
    EXPECT_GE(65535 * seen.period(), high - low) << time;
    if (seen.period() > 1.0 / 64) {
      EXPECT_LE(32767 * seen.period(), high - low + 1) << time;
    }
    expect_true(seen, truth);
  }
}

TEST(SeenStamps, AnEarlierScanTakesNoRoomFromTheNewest) {
  for (const double before : {1.0, 20.0, 23.9}) {  // 1024 s are all that the finest period spans
    Dice dice(6);
    SeenStamps seen;
    ScanGrid grid;
    Truth truth;
    for (const double time : {0.0, 1000.0, -before}) {
      random_look(dice, 20, grid, truth, time);
      seen.see(grid, time);
    }
    EXPECT_EQ(seen.period(), 1.0 / 64);
    expect_true(seen, truth);
  }
}

/// As many periods as there are stamps; with one more the newest look would have none.
TEST(SeenStamps, PeriodsGrowWhereOneMoreThanThereAreStampsIsSpanned) {
  for (const int periods : {65534, 65535}) {
    SeenStamps seen;
    ScanGrid grid;
    for (const int index : {0, periods}) {
      grid.clear();
      grid.set_free({index, 0, 0});
      seen.see(grid, index / 64.0);
    }
    EXPECT_EQ(seen.period(), periods == 65534 ? 1.0 / 64 : 1.0 / 32);
    expect_true(seen, {{{0, 0, 0}, 0.0}, {{periods, 0, 0}, periods / 64.0}});
  }
}

TEST(SeenStamps, AScanWithoutTimeStampsNothing) {
  Dice dice(3);
  SeenStamps seen;
  ScanGrid grid;
  Truth truth, ignored;
  for (const double time : {std::nan(""), HUGE_VAL, -HUGE_VAL, 1.1e12}) {
    random_look(dice, 20, grid, ignored, 0.0);
    seen.see(grid, time);
    EXPECT_TRUE(seen.empty());
    EXPECT_EQ(seen.voxels(), 0U);
  }
  random_look(dice, 20, grid, truth, 5.0);
  seen.see(grid, 5.0);
  random_look(dice, 20, grid, ignored, 0.0);
  seen.see(grid, std::nan(""));
  expect_true(seen, truth);
  EXPECT_EQ(seen.newest(), 5.0);
}

TEST(SeenStamps, ACopyDoesNotChangeWhenTheOriginalDoesNorTheOtherWayRound) {
  Dice dice(4);
  SeenStamps seen;
  ScanGrid grid;
  Truth truth;
  std::vector<std::pair<SeenStamps, Truth>> kept;
  kept.reserve(40);
  for (int scan = 0; scan < 30; ++scan) {
    const double time = scan < 20 ? scan : 700.0 * scan;  // the last ones change the period
    random_look(dice, 30, grid, truth, time);
    seen.see(grid, time, dice.whole(1, 3));
    if (scan % 3 == 0) kept.emplace_back(seen, truth);
    if (scan % 7 == 0) {
      SeenStamps other(seen);
      Truth also = truth;
      random_look(dice, 30, grid, also, time + 1);
      other.see(grid, time + 1);
      kept.emplace_back(other, also);
    }
  }
  for (const auto& [copy, then] : kept) expect_true(copy, then);
  expect_true(seen, truth);
}

TEST(SeenStamps, VisitsTheCellsOfABoxThatWereSeenSinceAndNoOther) {
  Dice dice(5);
  SeenStamps seen;
  ScanGrid grid;
  Truth truth;
  for (int scan = 0; scan < 25; ++scan) {
    random_look(dice, 30, grid, truth, 0.1 * scan);
    seen.see(grid, 0.1 * scan);
  }
  for (int round = 0; round < 40; ++round) {
    const double since = dice.uniform(-0.5, 2.6);
    Eigen::Vector3i first(dice.whole(-40, 30), dice.whole(-40, 30), dice.whole(-40, 30));
    Eigen::Vector3i last = first + Eigen::Vector3i(dice.whole(0, 50), dice.whole(0, 50), dice.whole(0, 50));
    if (round == 0) first.setConstant(-32768), last.setConstant(32767);
    std::map<Cell, int> visited;
    seen.visit_since(since, first, last, [&](const CellCube& cube) {
      ASSERT_TRUE(cube.edge == 1 ||
                  (cube.edge == 8 && cube.corner.unaryExpr([](int v) { return v & 7; }).isZero()));
      for (int i = 0; i < cube.edge * cube.edge * cube.edge; ++i) {
        const Eigen::Vector3i at = cube.corner + Eigen::Vector3i(i % cube.edge, i / cube.edge % cube.edge,
                                                                 i / cube.edge / cube.edge);
        ++visited[{at.x(), at.y(), at.z()}];
      }
    });
    std::size_t expected = 0;
    for (const auto& [cell, time] : truth) {
      const Eigen::Array3i at = vector_of(cell).array();
      const bool inside = (at >= first.array()).all() && (at <= last.array()).all();
      const bool wanted = inside && *seen.last_seen(at.matrix()) >= since;
      ASSERT_EQ(visited.contains(cell) ? visited.at(cell) : 0, wanted ? 1 : 0);
      expected += wanted ? 1U : 0U;
    }
    ASSERT_EQ(visited.size(), expected);
  }
}

TEST(SeenStamps, AreReadBackAsTheyWereWritten) {
  Dice dice(6);
  SeenStamps seen;
  ScanGrid grid;
  Truth truth;
  for (int scan = 0; scan < 300; ++scan) {  // blocks of many stamps
    random_look(dice, 12, grid, truth, 3.0 * scan);
    seen.see(grid, 3.0 * scan);
  }
  const std::string bytes = format_seen(seen);
  const SeenStamps read = parse_seen(bytes, "seen");
  expect_true(read, truth);
  EXPECT_EQ(read.newest(), seen.newest());
  EXPECT_EQ(format_seen(read), bytes);
  EXPECT_LE(read.bytes(), 20 * bytes.size());
  EXPECT_EQ(read.oldest(), seen.oldest());
}

TEST(SeenStamps, BytesThatAreNoneAreRefusedOrReadAsStampsThatHold) {
  Dice dice(7);
  SeenStamps seen;
  ScanGrid grid;
  Truth truth;
  for (int scan = 0; scan < 5; ++scan) {
    random_look(dice, 12, grid, truth, 0.5 * scan);
    seen.see(grid, 0.5 * scan);
  }
  const std::string bytes = format_seen(seen);
  int refused = 0;
  for (int round = 0; round < 2000; ++round) {
    std::string damaged = bytes;
    if (round % 4 == 0)
      damaged.resize(static_cast<std::size_t>(dice.whole(0, static_cast<int>(bytes.size()) - 1)));
    for (int change = round % 4; change > 0; --change) {
      const int within = round % 2 == 0 ? static_cast<int>(damaged.size()) : 60;
      damaged[static_cast<std::size_t>(dice.whole(0, within - 1))] = static_cast<char>(dice.whole(0, 255));
    }
    try {
      const SeenStamps read = parse_seen(damaged, "seen");
      ASSERT_LE(read.oldest(), read.newest());
      read.visit_since(std::nextafter(read.newest(), HUGE_VAL), Eigen::Vector3i::Constant(-32768),
                       Eigen::Vector3i::Constant(32767), [&](const CellCube& cube) {
                         ADD_FAILURE()
                             << round << ": " << cube.corner.transpose() << " was seen after the newest look";
                       });
      ASSERT_LE(read.bytes(), 20 * damaged.size() + 1000);
    } catch (const DamagedFile& error) {
      ++refused;
      EXPECT_NE(std::string(error.what()).find("'seen' is damaged"), std::string::npos);
    }
  }
  EXPECT_GT(refused, 600);
}

TEST(SeenStamps, OfTwoMapsTheLaterLookCounts) {
  Dice dice(8);
  for (const double apart : {0.0, 500.0, -90000.0}) {
    SeenStamps a, b;
    ScanGrid grid;
    Truth truth;
    for (int scan = 0; scan < 20; ++scan) {
      random_look(dice, 25, grid, truth, scan);
      a.see(grid, scan);
      random_look(dice, 25, grid, truth, scan * 1.1 + apart);
      b.see(grid, scan * 1.1 + apart);
    }
    const std::string before = format_seen(a) + format_seen(b);
    expect_true(SeenStamps::later(a, b), truth);
    expect_true(SeenStamps::later(b, a), truth);
    EXPECT_EQ(format_seen(SeenStamps::later(a, b)), format_seen(SeenStamps::later(b, a)));
    EXPECT_EQ(SeenStamps::later(a, b).newest(), std::max(a.newest(), b.newest()));
    EXPECT_EQ(format_seen(a) + format_seen(b), before);
    EXPECT_EQ(format_seen(SeenStamps::later(a, SeenStamps())), format_seen(a));
    EXPECT_EQ(format_seen(SeenStamps::later(SeenStamps(), a)), format_seen(a));
  }
}

TEST(SeenStamps, ACropKeepsItsCellsAndACoarserVoxelIsAsOldAsItsOldestPart) {
  Dice dice(9);
  SeenStamps seen;
  ScanGrid grid;
  Truth truth;
  for (int scan = 0; scan < 40; ++scan) {
    random_look(dice, 20, grid, truth, scan);
    seen.see(grid, scan);
  }
  const auto expect_cropped = [&](const Eigen::Vector3i& first, const Eigen::Vector3i& last) {
    Truth inside;
    for (const auto& [cell, time] : truth) {
      const Eigen::Array3i at = vector_of(cell).array();
      if ((at >= first.array()).all() && (at <= last.array()).all()) inside[cell] = time;
    }
    EXPECT_FALSE(inside.empty());
    expect_true(seen.cropped(first, last), inside);
  };
  expect_cropped({-9, -20, -3}, {14, 11, 30});
  for (int axis = 0; axis < 3; ++axis) {  // from one side alone, too
    for (int i = 0; i < 5; ++i) {
      Eigen::Vector3i first = Eigen::Vector3i::Constant(-100), last = Eigen::Vector3i::Constant(100);
      first[axis] = dice.whole(-15, 15);
      expect_cropped(first, last);
      std::swap(first[axis], last[axis]);
      first[axis] = -100;
      expect_cropped(first, last);
    }
  }

  const auto half = [](int value) { return value >= 0 ? value / 2 : -((1 - value) / 2); };
  std::map<Cell, std::pair<int, double>>
      parts;  // of each coarse cell: how many were seen, and the oldest look
  for (const auto& [cell, time] : truth) {
    const Eigen::Vector3i at = vector_of(cell).unaryExpr(half);
    auto& [count, oldest] = parts.try_emplace({at.x(), at.y(), at.z()}, 0, time).first->second;
    ++count;
    oldest = std::min(oldest, time);
  }
  Truth coarse;
  for (const auto& [cell, part] : parts) {
    if (part.first == 8) coarse[cell] = part.second;
  }
  EXPECT_GT(coarse.size(), 500U);
  expect_true(seen.halved(), coarse);
  expect_true(seen, truth);
}

/// Takes all memory that this process, which ends soon, may have, but for so many bytes. The limit before.
rlimit leave_memory(std::size_t bytes) {
  rlimit before{};
  getrlimit(RLIMIT_AS, &before);
  void* const left = std::malloc(bytes);
  std::ifstream statm("/proc/self/statm");
  std::size_t pages = 0;
  statm >> pages;
  const rlimit no_more{pages * static_cast<std::size_t>(sysconf(_SC_PAGESIZE)), before.rlim_max};
  setrlimit(RLIMIT_AS, &no_more);
  for (void* volatile taken = left; taken != nullptr;) taken = std::malloc(512);
  std::free(left);
  return before;
}

/// Of a scan of which not all could be stamped the rest was never seen, also in a crop.
TEST(SeenStamps, WhatMemoryDidNotLastForWasNotSeen) {
  if (address_sanitized || thread_sanitized) GTEST_SKIP();
  const auto work = [&]() -> std::string {
    SeenStamps seen;
    ScanGrid grid;
    constexpr int tiles = 8000;
    const auto cell = [](int tile) {
      return Eigen::Vector3i(32 * tile - 32000 * (tile / 1000), 32 * (tile / 1000), 0);
    };
    for (int i = 0; i < tiles; ++i) grid.set_free(cell(i));
    const rlimit before = leave_memory(std::size_t{4} << 20U);
    bool is_short = false;
    try {
      seen.see(grid, 1.0);
    } catch (const std::bad_alloc&) {
      is_short = true;
    }
    setrlimit(RLIMIT_AS, &before);
    const SeenStamps all = seen.cropped(cell(0), cell(tiles - 1));
    int stamped = 0;
    for (int i = 0; i < tiles; ++i) {
      stamped += seen.last_seen(cell(i)).has_value() ? 1 : 0;
      if (seen.last_seen(cell(i)) != all.last_seen(cell(i))) return "the crop says other than the map";
    }
    if (!is_short) return "memory lasted";
    return stamped > 0 && stamped < tiles ? "some" : std::to_string(stamped) + " of them";
  };
  const ChildOutcome outcome = run_in_child(work, {std::size_t{4} << 30U, 10000, 60});
  ASSERT_TRUE(outcome.finished) << outcome.failure;
  EXPECT_EQ(outcome.parts.at(0), "some");
}

}  // namespace seen_stamps_test
}  // namespace clearway
