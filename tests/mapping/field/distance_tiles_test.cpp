// Distances of changing cells, looked at in any order, against brute force and against a fresh start.

#include "mapping/field/distance_tiles.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <thread>

#include "tests/worlds/random_map.hpp"

namespace clearway {
namespace distance_tiles_test {

using worlds::Dice;

Eigen::Vector3i random_cell(Dice& dice, const Eigen::Vector3i& size) {
  return {dice.whole(0, size.x() - 1), dice.whole(0, size.y() - 1), dice.whole(0, size.z() - 1)};
}

void fill_box(Dice& dice, BlockedCells& cells, int edge, bool blocked) {
  const Eigen::Vector3i low = random_cell(dice, cells.size());
  const Eigen::Vector3i reach(dice.whole(1, edge), dice.whole(1, edge), dice.whole(1, edge));
  cells.fill(low, (low + reach).cwiseMin(cells.size()), blocked);
}

template <class Visit>
void visit_cells(const Eigen::Vector3i& size, const Visit& visit) {
  for (int z = 0; z < size.z(); ++z) {
    for (int y = 0; y < size.y(); ++y) {
      for (int x = 0; x < size.x(); ++x) visit(x, y, z);
    }
  }
}

std::size_t count_differences(const DistanceTiles& a, const DistanceTiles& b) {
  std::size_t count = 0;
  visit_cells(a.size(), [&](int x, int y, int z) { count += a.squared(x, y, z) != b.squared(x, y, z); });
  return count;
}

/// Copies what it is asked for; the rest of the copy stays as it is.
DistanceTiles::ReadCells reading(const BlockedCells& cells) {
  return [&cells](const DistanceTiles::Box& box, BlockedCells& copy) {
    for (int z = box.low.z(); z < box.high.z(); ++z) {
      for (int y = box.low.y(); y < box.high.y(); ++y) {
        for (int x = box.low.x(); x < box.high.x(); ++x) copy.set(x, y, z, cells.at(x, y, z));
      }
    }
  };
}

/// Boxes about the blocked cells of the same block, wider than they have to be.
DistanceTiles::VisitBlocked visiting(const BlockedCells& cells, int wider) {
  return [&cells, wider](const std::function<void(const DistanceTiles::Box&)>& visit) {
    visit_cells(cells.size(), [&](int x, int y, int z) {
      if (!cells.at(x, y, z)) return;
      const Eigen::Array3i low = Eigen::Array3i(x, y, z) - wider, high = Eigen::Array3i(x, y, z) + 1 + wider;
      visit({low.max(0).matrix(), high.min(cells.size().array()).matrix()});
    });
  };
}

/// Every cell of the tiles against the distances to all blocked cubes.
void expect_exact(const DistanceTiles& tiles, const std::vector<Eigen::Vector3i>& cells) {
  visit_cells(tiles.size(), [&](int x, int y, int z) {
    int expected = tiles.cap();
    for (const Eigen::Vector3i& cell : cells) {
      const Eigen::Vector3i gap =
          (2 * (cell - Eigen::Vector3i(x, y, z)).cwiseAbs().array() - 1).max(0).matrix();
      expected = std::min(expected, gap.squaredNorm());
    }
    ASSERT_EQ(int{tiles.squared(x, y, z)}, expected)
        << x << " " << y << " " << z << " cap " << tiles.cap() << " of " << tiles.blocked().count();
  });
}

TEST(DistanceTiles, HoldExactlyTheDistanceToTheNearestCube) {
  Dice dice(1);
  for (int trial = 0; trial < 30; ++trial) {
    const Eigen::Vector3i size(dice.whole(1, 70), dice.whole(1, 30), dice.whole(1, 30));
    BlockedCells blocked(size, false);
    std::vector<Eigen::Vector3i> cells;
    for (int i = dice.whole(0, 25); i > 0; --i) {
      cells.push_back(random_cell(dice, size));
      blocked.fill(cells.back(), cells.back() + Eigen::Vector3i::Ones(), true);
    }
    const auto cap = static_cast<std::uint16_t>(dice.whole(1, trial % 2 == 0 ? 400 : largest_cap));
    if (trial % 3 == 0)
      expect_exact(DistanceTiles(blocked, cap), cells);
    else
      expect_exact(
          DistanceTiles(size, cap, reading(blocked),
                        trial % 3 == 1 ? visiting(blocked, trial % 2) : DistanceTiles::VisitBlocked()),
          cells);
  }
}

TEST(DistanceTiles, AreExactForTheSmallestCapsAndACubeAnywhereInARow) {
  for (const std::uint16_t cap : {1, 2, 9, 10, 11, 25, 26}) {  // just what some of the nearest cells are away
    for (int x = 0; x < 66; ++x) {                             // two words of a row, and a bit
      const Eigen::Vector3i cell(x, x % 3, x / 3 % 3);
      BlockedCells blocked({66, 3, 3}, false);
      const DistanceTiles empty(blocked, cap);
      empty.complete();
      blocked.fill(cell, cell + Eigen::Vector3i::Ones(), true);
      expect_exact(DistanceTiles(blocked, cap), {cell});
      expect_exact(DistanceTiles(empty, blocked), {cell});
    }
  }
}

// Some cells are looked at between two changes, others never were when the next change comes.
TEST(DistanceTiles, AfterAnySequenceOfChangesAndLooksTheyAreThoseMadeFromNothing) {
  Dice dice(2);
  for (int trial = 0; trial < 12; ++trial) {
    const Eigen::Vector3i size(dice.whole(1, 150), dice.whole(1, 60), dice.whole(1, 60));
    const auto cap = static_cast<std::uint16_t>(dice.whole(1, trial % 2 == 0 ? 3000 : largest_cap));
    BlockedCells blocked(size, trial % 4 == 0);
    std::vector<BlockedCells> versions(11, blocked);  // readers refer to them
    const auto visit = [&, is_asked = trial % 3 != 0, wider = trial % 2](const BlockedCells& cells) {
      return is_asked ? visiting(cells, wider) : DistanceTiles::VisitBlocked();
    };
    auto tiles = std::make_unique<DistanceTiles>(size, cap, reading(versions[0]), visit(versions[0]));
    for (std::size_t round = 1; round < versions.size(); ++round) {
      const BlockedCells before = blocked;
      for (int i = dice.whole(0, 8); i > 0; --i)
        fill_box(dice, blocked, dice.whole(1, 20), dice.whole(0, 1) == 0);
      versions[round] = blocked;
      const auto follow = [&](BlockedCells& cells) {
        std::vector<CellBox> changes;
        visit_cells(size, [&](int x, int y, int z) {
          if (before.at(x, y, z) == blocked.at(x, y, z)) return;
          cells.set(x, y, z, blocked.at(x, y, z));
          changes.push_back({{x, y, z}, {x + 1, y + 1, z + 1}});
        });
        if (round % 2 == 0) changes = before.differing(blocked);  // which may be larger boxes
        return changes;
      };
      tiles =
          std::make_unique<DistanceTiles>(*tiles, follow, reading(versions[round]), visit(versions[round]));
      if (round % 2 == 0) tiles->renew();
      const DistanceTiles fresh(blocked, cap);
      for (int i = dice.whole(0, 40); i > 0; --i) {
        const Eigen::Vector3i at = random_cell(dice, size);
        ASSERT_EQ(tiles->squared(at.x(), at.y(), at.z()), fresh.squared(at.x(), at.y(), at.z()));
        ASSERT_EQ(tiles->is_blocked(at.x(), at.y(), at.z()), blocked.at(at.x(), at.y(), at.z()));
      }
      if (round % 3 == 0) {
        ASSERT_EQ(count_differences(*tiles, fresh), 0U);
        ASSERT_EQ(tiles->blocked(), blocked);
      }
    }
  }
}

TEST(DistanceTiles, AreTheSameForManyThreadsThatLookAtOnce) {
  Dice dice(4);
  BlockedCells blocked({150, 70, 60}, false);
  for (int i = 0; i < 30; ++i) fill_box(dice, blocked, 15, true);
  const DistanceTiles alone(blocked, 1500);
  const DistanceTiles shared(blocked.size(), 1500, reading(blocked));
  std::vector<std::size_t> differences(4, 0);
  std::vector<std::thread> threads;
  for (std::size_t t = 0; t < differences.size(); ++t) {
    threads.emplace_back([&, t] {
      Dice own(static_cast<unsigned>(10 + t));
      for (int i = 0; i < 4000; ++i) {
        const Eigen::Vector3i at = random_cell(own, blocked.size());
        if (i % 2 == 0)
          differences[t] += shared.is_blocked(at.x(), at.y(), at.z()) != blocked.at(at.x(), at.y(), at.z());
        else
          differences[t] +=
              (shared.squared(at.x(), at.y(), at.z()) == 0) != blocked.at(at.x(), at.y(), at.z());
      }
    });
  }
  for (std::thread& thread : threads) thread.join();
  EXPECT_EQ(differences, std::vector<std::size_t>(4, 0));
  EXPECT_EQ(count_differences(shared, alone), 0U);
}

// Those who look at the version before read its cells while the next one is made.
TEST(DistanceTiles, ALaterVersionIsRightWhileOthersLookAtTheOneBefore) {
  Dice dice(9);
  const Eigen::Vector3i size(32, 400, 8);
  const DistanceTiles::ReadCells all_twice = [](const DistanceTiles::Box& box, BlockedCells& cells) {
    cells.fill(box.low, box.high, true);  // as under known_free: first all, then less what is free
    cells.fill(box.low, box.high, false);
  };
  for (int trial = 0; trial < 20; ++trial) {
    const DistanceTiles before(size, 30, all_twice);
    before.squared(5, 399, 7);
    std::thread looking([&before] {
      for (int y = 0; y < 380; y += 8) before.is_blocked(0, y, 0);
    });
    for (int version = 0; version < 20; ++version) {
      const Eigen::Vector3i changed(dice.whole(0, 31), dice.whole(392, 399), dice.whole(0, 7));
      const CellBox cell{changed, changed + Eigen::Vector3i::Ones()};
      const auto block = [&](BlockedCells& cells) {
        cells.fill(cell.low, cell.high, true);
        return std::vector<CellBox>{cell};
      };
      const DistanceTiles after(before, block, all_twice);
      EXPECT_EQ(after.squared(changed.x(), changed.y(), changed.z()), 0) << changed.transpose();
    }
    looking.join();
  }
}

TEST(DistanceTiles, TheVersionBeforeAChangeStaysAsItWas) {
  Dice dice(3);
  BlockedCells blocked({100, 50, 40}, false);
  for (int i = 0; i < 30; ++i) fill_box(dice, blocked, 9, true);
  const DistanceTiles before(blocked, 1500);
  before.complete();
  BlockedCells later = blocked;
  for (int i = 0; i < 30; ++i) fill_box(dice, later, 9, i % 2 == 0);
  const DistanceTiles after(before, later);
  EXPECT_EQ(count_differences(before, DistanceTiles(blocked, 1500)), 0U);
  EXPECT_GT(count_differences(before, after), 1000U);
}

TEST(DistanceTiles, RenewComputesWhatAnyEarlierVersionKnew) {
  Dice dice(5);
  BlockedCells blocked({200, 90, 80}, false);
  for (int i = 0; i < 10; ++i) fill_box(dice, blocked, 9, true);
  const DistanceTiles first(blocked, 900);
  first.complete();
  const std::size_t all = first.known();
  fill_box(dice, blocked, 12, true);
  const DistanceTiles second(first, blocked);
  EXPECT_LT(second.known(), all);
  fill_box(dice, blocked, 12, true);
  const DistanceTiles third(second, blocked);
  EXPECT_LT(third.known(), all);
  third.renew();
  EXPECT_EQ(third.known(), all);
  EXPECT_EQ(count_differences(third, DistanceTiles(blocked, 900)), 0U);
}

// A cube that comes or goes right behind a wall is nearest to nothing before the wall.
TEST(DistanceTiles, AChangeBehindWhatIsNearerReachesNoTile) {
  BlockedCells blocked({96, 64, 64}, false);
  blocked.fill({0, 0, 24}, {96, 64, 26}, true);
  const DistanceTiles before(blocked, 2500);
  before.complete();
  blocked.fill({40, 30, 40}, {50, 40, 46}, true);
  const DistanceTiles with(before, blocked);
  for (int z = 0; z < 24; ++z) EXPECT_EQ(before.line(1, 32, z), with.line(1, 32, z)) << z;
  EXPECT_NE(before.line(1, 32, 38), with.line(1, 32, 38));
  with.complete();
  blocked.fill({40, 30, 40}, {50, 40, 46}, false);
  const DistanceTiles without(with, blocked);
  for (int z = 0; z < 24; ++z) EXPECT_EQ(without.line(1, 32, z), with.line(1, 32, z)) << z;
  EXPECT_EQ(count_differences(without, before), 0U);
}

// The uppermost tiles hold only some layers of the block: what is above them is no reason to compute them
// anew.
TEST(DistanceTiles, AChangeFartherThanAllDistancesOfACutTileDoesNotReachIt) {
  for (const int height : {9, 11, 15, 16}) {
    BlockedCells blocked({96, 16, height}, false);
    blocked.fill({0, 0, height - 1}, {96, 16, height}, true);
    const DistanceTiles before(blocked, 2500);
    before.complete();
    blocked.fill({80, 5, 8}, {81, 6, 9}, true);
    const DistanceTiles after(before, blocked);
    for (int lane = 0; lane < 2; ++lane) EXPECT_EQ(before.line(lane, 8, 8), after.line(lane, 8, 8)) << height;
    EXPECT_EQ(before.line(2, 5, 8) == after.line(2, 5, 8), height == 9) << height;  // the cell was blocked
    EXPECT_EQ(count_differences(after, DistanceTiles(blocked, 2500)), 0U);
  }
}

TEST(DistanceTiles, ASmallChangeCopiesFewTiles) {
  BlockedCells blocked({320, 160, 160}, false);
  blocked.fill({0, 0, 0}, {320, 160, 2}, true);
  const DistanceTiles before(blocked, 400);
  before.complete();
  blocked.fill({160, 80, 50}, {161, 81, 51}, true);
  const DistanceTiles after(before, blocked);
  std::size_t shared = 0, lines = 0;
  for (int z = 0; z < 160; ++z) {
    for (int y = 0; y < 160; ++y) {
      for (int lane = 0; lane < 10; ++lane, ++lines)
        shared += before.line(lane, y, z) == after.line(lane, y, z);
    }
  }
  EXPECT_GT(shared, lines * 95 / 100);
  EXPECT_LT(shared, lines);
}

TEST(DistanceTiles, OneLookComputesOneTileAndReadsOnlyWhatReachesIt) {
  BlockedCells blocked({320, 160, 160}, true);
  std::size_t read = 0;
  const auto counting = [&, copy = reading(blocked)](const DistanceTiles::Box& box, BlockedCells& cells) {
    copy(box, cells);
    ++read;
  };
  const DistanceTiles tiles(blocked.size(), 225, counting);  // 8 voxels: a tile to each side
  EXPECT_EQ(read, 0U);
  EXPECT_EQ(tiles.squared(100, 80, 80), 0);
  EXPECT_EQ(tiles.known(), 1U);
  EXPECT_EQ(read, 1U);  // of a tile that is all blocked no other matters
  blocked.set(250, 81, 82, false);
  EXPECT_EQ(tiles.squared(250, 81, 82), 1);
  EXPECT_EQ(tiles.known(), 2U);
  EXPECT_EQ(read, 1U + 27U);
}

// Where boxes say that nothing is blocked, nothing is read, and a change there is known to matter.
TEST(DistanceTiles, TilesOutsideOfTheBoxesOfBlockedCellsAreNotRead) {
  BlockedCells blocked({320, 160, 160}, false);
  blocked.fill({100, 80, 80}, {101, 81, 81}, true);
  std::size_t read = 0;
  const auto counting = [&, copy = reading(blocked)](const DistanceTiles::Box& box, BlockedCells& cells) {
    copy(box, cells);
    ++read;
  };
  const DistanceTiles tiles(blocked.size(), 225, counting, visiting(blocked, 0));
  EXPECT_EQ(tiles.squared(101, 80, 80), 1);
  EXPECT_EQ(tiles.squared(10, 10, 10), 225);
  EXPECT_EQ(read, 1U);
  EXPECT_FALSE(tiles.is_blocked(300, 10, 10));
  EXPECT_EQ(read, 1U);
  const auto follow = [](BlockedCells& cells) {
    cells.set(12, 10, 10, true);
    return std::vector<CellBox>{{{12, 10, 10}, {13, 11, 11}}};
  };
  BlockedCells later = blocked;
  later.set(12, 10, 10, true);
  const DistanceTiles after(tiles, follow, reading(later), visiting(later, 0));
  EXPECT_EQ(after.squared(10, 10, 10), 9);
  EXPECT_EQ(after.squared(101, 80, 80), 1);
}

TEST(DistanceTiles, EmptySpaceTakesHardlyAnyMemory) {
  const DistanceTiles empty(BlockedCells({256, 256, 256}, false), 400);
  empty.complete();
  EXPECT_LT(empty.bytes(), 256U * 256U * 256U / 4U);
}

TEST(DistanceTiles, TheirBytesAreTheBitsAndWhatIsKeptOfEachLook) {
  constexpr std::size_t tile_bytes = DistanceTiles::tile_cells * sizeof(std::uint16_t);
  BlockedCells blocked({32, 8, 16}, false);  // two tiles
  const DistanceTiles none(blocked, 25);
  EXPECT_EQ(none.bytes(), blocked.bytes());
  none.complete();
  EXPECT_EQ(none.bytes(), blocked.bytes());
  blocked.fill({3, 3, 3}, {4, 4, 4}, true);
  const DistanceTiles one(blocked, 25);  // two cells: not the other tile
  EXPECT_EQ(one.bytes(), blocked.bytes());
  one.squared(0, 0, 0);
  const std::size_t looked_at = one.bytes();
  EXPECT_EQ(looked_at, blocked.bytes() + 3 * tile_bytes);  // and steps along z, and within planes
  one.squared(31, 7, 7);
  EXPECT_EQ(one.bytes(), looked_at);
}

}  // namespace distance_tiles_test
}  // namespace clearway
