#include "mapping/safe_scan.hpp"

#include <gtest/gtest.h>

#include <cstdlib>
#include <set>

#include "tests/mapping/random_map.hpp"

namespace clearway {
namespace {

using testing::Dice;
using Cell = std::array<int, 3>;

/// Reached by the steps, cell by cell: the slow and obvious twin.
std::set<Cell> grown(std::set<Cell> cells, const std::vector<GrowthStep>& growth) {
  for (const GrowthStep step : growth) {
    const std::set<Cell> before = cells;
    for (const Cell& c : before) {
      for (int x = -1; x <= 1; ++x)
        for (int y = -1; y <= 1; ++y)
          for (int z = -1; z <= 1; ++z)
            if (std::abs(x) + std::abs(y) + std::abs(z) <= 1 + static_cast<int>(step))
              cells.insert({c[0] + x, c[1] + y, c[2] + z});
    }
  }
  return cells;
}

int draw(Dice& dice, int low, int high) { return static_cast<int>(std::floor(dice.uniform(low, high))); }

TEST(SafeScan, TakesExactlyTheCellsNearHitsOutOfTheFreeOnes) {
  const auto f = GrowthStep::faces, e = GrowthStep::edges, q = GrowthStep::cube;
  const std::vector<std::vector<GrowthStep>> growths{{},           {f},    {e},       {q},
                                                     {q, q, q, q}, {e, f}, {e, f, e}, {e, f, e, f}};
  for (unsigned seed = 0; seed < 60; ++seed) {
    Dice dice(seed);
    const int corner = seed % 3 == 0   ? -32768
                       : seed % 3 == 1 ? 32768 - 40
                                       : -20;  // ends of the key range too
    const auto any = [&] {
      return Cell{corner + draw(dice, 0, 40), corner + draw(dice, 0, 40), corner + draw(dice, 0, 40)};
    };
    std::set<Cell> free, hit;
    ScanGrid grid;
    for (int i = 0; i < 20000; ++i) {
      const Cell c = any();
      free.insert(c);
      grid.set_free({c[0], c[1], c[2]});
    }
    for (int i = 0; i < 30; ++i) {
      const Cell c = any();
      hit.insert(c);
      grid.set_occupied({c[0], c[1], c[2]});
    }
    const auto& growth = growths[seed % growths.size()];
    spare_surfaces(grid, growth, 1 + static_cast<int>(seed % 3));
    const std::set<Cell> spared = grown(hit, growth);
    for (const Cell& c : free) {
      const bool kept = growth.empty() || !spared.contains(c);
      ASSERT_EQ(grid.is_free({c[0], c[1], c[2]}), kept) << c[0] << ' ' << c[1] << ' ' << c[2];
    }
    for (const Cell& c : hit) ASSERT_TRUE(grid.is_occupied({c[0], c[1], c[2]}));
  }
}

TEST(SafeScan, TheNeighbourhoodIsTheBandInWholeVoxelsAtMostFour) {
  for (const double resolution : {0.1, 0.05, 0.03, 0.02, 0.01, 0.005, 0.0025}) {
    const auto growth = growth_of(0.02, resolution);
    const int n = std::max(1, static_cast<int>(std::min(4.0, std::round(0.02 / resolution))));
    int along = 0, sum = 0;
    for (const Cell& c : grown({{0, 0, 0}}, growth)) {
      along = std::max({along, std::abs(c[0]), std::abs(c[1]), std::abs(c[2])});
      sum = std::max(sum, std::abs(c[0]) + std::abs(c[1]) + std::abs(c[2]));
    }
    EXPECT_EQ(along, n) << resolution;
    EXPECT_EQ(sum, resolution > 0.04 ? 1 : n == 1 ? 3 : n + (n + 1) / 2) << resolution;
  }
  EXPECT_TRUE(growth_of(0.0, 0.02).empty());
}

TEST(SafeScan, TrimsByTheNoiseOfTheRangeUpToItsLimit) {
  const SafeMargins margins;
  EXPECT_DOUBLE_EQ(margins.trim(0.0), 3 * 0.0012);
  EXPECT_DOUBLE_EQ(margins.trim(2.0), 3 * (0.0012 + 4 * 0.0019));
  EXPECT_DOUBLE_EQ(margins.trim(100.0), 3 * 0.05);
}

}  // namespace
}  // namespace clearway
