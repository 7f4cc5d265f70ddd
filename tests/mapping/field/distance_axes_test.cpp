// The steps of the distance transform, for each kind of vector registers that this machine has.

#include "mapping/field/distance_axes.hpp"

#include <gtest/gtest.h>

#include <algorithm>

#include "tests/worlds/instruction_sets.hpp"
#include "tests/worlds/random_map.hpp"

namespace clearway {
namespace distance_axes_test {

using worlds::Dice;

std::uint16_t random_cap(Dice& dice) {
  return static_cast<std::uint16_t>(dice.whole(0, 1) == 0 ? dice.whole(1, 400)
                                                          : dice.whole(400, largest_cap));
}

TEST(DistanceAxes, TheWindowHoldsAllStepsWhoseGapIsBelowTheCap) {
  for (const int cap : {1, 2, 9, 10, 2676, 32767}) {
    const int window = DistanceAxes(static_cast<std::uint16_t>(cap)).window();
    EXPECT_LT(gap_squared(window), cap);
    EXPECT_GE(gap_squared(window + 1), cap);
  }
}

TEST(DistanceAxes, StepsAreCountedToTheNearestSetBit) {
  Dice dice(1);
  for (int trial = 0; trial < 40; ++trial) {
    const int lines = dice.whole(1, 5), count = dice.whole(1, 120);
    std::vector<std::uint32_t> words(static_cast<std::size_t>(lines * count));
    for (int i = 0; i < dice.whole(0, 60); ++i) {
      words[static_cast<std::size_t>(dice.whole(0, lines * count - 1))] |= 1U << dice.whole(0, 31);
    }
    const std::uint16_t cap = random_cap(dice);
    for (const InstructionSet kind : worlds::instruction_sets()) {
      const DistanceAxes axes(cap, kind);
      std::vector<std::uint8_t> steps(words.size() * lane_cells);
      axes.count_steps(words.data(), lines, count, steps.data());
      for (int at = 0; at < count; ++at) {
        for (int cell = 0; cell < lines * lane_cells; ++cell) {
          int expected = axes.window() + 1;
          for (int other = 0; other < count; ++other) {
            const auto word = words[static_cast<std::size_t>(other * lines + cell / lane_cells)];
            if ((word >> (cell % lane_cells) & 1U) != 0) expected = std::min(expected, std::abs(other - at));
          }
          ASSERT_EQ(int{steps[static_cast<std::size_t>(at * lines * lane_cells + cell)]}, expected);
        }
      }
    }
  }
}

TEST(DistanceAxes, StepsAreSquaredUpToTheCap) {
  Dice dice(2);
  for (int trial = 0; trial < 200; ++trial) {
    const std::uint16_t cap = random_cap(dice);
    for (const InstructionSet kind : worlds::instruction_sets()) {
      const DistanceAxes axes(cap, kind);
      std::array<std::uint8_t, lane_cells> steps{};
      bool any = false;
      const int least = dice.whole(0, axes.window() + 1);
      for (auto& step : steps) {
        step = static_cast<std::uint8_t>(dice.whole(least, axes.window() + 1));
        any = any || step <= axes.window();
      }
      std::array<std::uint16_t, lane_cells> squared{};
      ASSERT_EQ(axes.square_steps(steps.data(), squared.data()), any);
      for (std::size_t k = 0; k < steps.size(); ++k) {
        ASSERT_EQ(int{squared[k]}, std::min(gap_squared(steps[k]), int{cap}));
      }
    }
  }
}

TEST(DistanceAxes, TheLeastSumWithinTheWindowIsFoundAcrossLinesAndAlongThem) {
  Dice dice(3);
  for (int trial = 0; trial < 300; ++trial) {
    const std::uint16_t cap = random_cap(dice);
    const int stride = dice.whole(0, 1) == 0 ? 1 : lane_cells;
    const int margin = DistanceAxes(cap).margin() * stride;
    std::vector<std::uint16_t> cells(static_cast<std::size_t>(2 * margin + lane_cells), cap);
    for (int i = 0; i < dice.whole(0, 30); ++i) {
      const int at = dice.whole(0, static_cast<int>(cells.size()) - 1);
      cells[static_cast<std::size_t>(at)] = static_cast<std::uint16_t>(dice.whole(0, cap));
    }
    for (const InstructionSet kind : worlds::instruction_sets()) {
      const DistanceAxes axes(cap, kind);
      std::array<std::uint16_t, lane_cells> out{};
      axes.lower(&cells[static_cast<std::size_t>(margin)], stride, 1, out.data());
      for (int k = 0; k < lane_cells; ++k) {
        int expected = cap;
        for (int step = -axes.window(); step <= axes.window(); ++step) {
          const int from = cells[static_cast<std::size_t>(margin + k + step * stride)];
          expected = std::min(expected, from + gap_squared(std::abs(step)));
        }
        ASSERT_EQ(int{out[static_cast<std::size_t>(k)]}, expected);
      }
    }
  }
}

TEST(DistanceAxes, AnyOf32NumbersAtLeastAValueIsFound) {
  Dice dice(4);
  for (int trial = 0; trial < 2000; ++trial) {
    std::array<std::uint16_t, lane_cells> numbers{};
    for (auto& number : numbers) number = static_cast<std::uint16_t>(dice.whole(0, 40));
    const auto value = static_cast<std::uint16_t>(dice.whole(0, 41));
    const bool expected = *std::max_element(numbers.begin(), numbers.end()) >= value;
    for (const InstructionSet kind : worlds::instruction_sets()) {
      ASSERT_EQ(DistanceAxes(100, kind).any_at_least(numbers.data(), value), expected);
    }
  }
}

}  // namespace distance_axes_test
}  // namespace clearway
