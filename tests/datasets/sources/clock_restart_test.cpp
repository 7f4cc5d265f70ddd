#include "datasets/sources/clock_restart.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <optional>
#include <random>
#include <vector>

namespace clearway {
namespace clock_restart_test {

/// Times from `first`, `step` s apart.
std::vector<double> run_of(double first, double step, int count) {
  std::vector<double> times;
  for (int i = 0; i < count; ++i) times.push_back(first + step * i);
  return times;
}

std::vector<double> joined(std::vector<double> a, const std::vector<double>& b) {
  a.insert(a.end(), b.begin(), b.end());
  return a;
}

TEST(ClockRestart, IsTheFirstMessageOfARunThatPassesTheSameTimesAgain) {
  EXPECT_EQ(find_restart(joined(run_of(10, 0.05, 61), run_of(10, 0.05, 61))), 61U);
  EXPECT_EQ(find_restart(joined(run_of(10, 0.6, 4), run_of(10, 0.6, 4))), 4U) << "slow scans";
  EXPECT_EQ(find_restart(joined(run_of(10, 0.05, 61), run_of(0, 0.05, 400))), 61U) << "longer, from 0 on";
  const std::vector<double> lap = run_of(3, 0.1, 50), three = joined(joined(lap, lap), lap);
  EXPECT_EQ(find_restart(three), 50U);
  EXPECT_EQ(find_restart(std::span(three).subspan(50)), 50U);
}

TEST(ClockRestart, DisorderIsNone) {
  EXPECT_FALSE(find_restart({}));
  EXPECT_FALSE(find_restart(run_of(10, 0.1, 1)));
  EXPECT_FALSE(find_restart(run_of(10, 0.1, 100)));
  EXPECT_FALSE(find_restart(joined(run_of(10, 0.1, 50), run_of(14.2, 0.1, 50)))) << "0.7 s back";
  EXPECT_FALSE(find_restart(joined(run_of(22, 1, 3), run_of(10, 1, 12)))) << "parts in another order";
  std::vector<double> reversed = run_of(0, 0.3, 100);
  std::reverse(reversed.begin(), reversed.end());
  EXPECT_FALSE(find_restart(reversed));
  std::vector<double> late = run_of(0, 0.1, 300);
  for (std::size_t i = 29; i < late.size(); i += 20) std::rotate(&late[i - 25], &late[i - 24], &late[i]);
  EXPECT_FALSE(find_restart(late)) << "single messages 2.5 s late";
}

TEST(ClockRestart, ShuffledStreamsAreNoneAndShuffledALittleTheRestartIsStillFound) {
  std::mt19937 random(5);
  for (int trial = 0; trial < 300; ++trial) {
    std::vector<double> times = run_of(0, 0.05, 60 + static_cast<int>(trial % 2 * (random() % 400)));
    std::shuffle(times.begin(), times.end(), random);
    EXPECT_FALSE(find_restart(times)) << trial;
    std::vector<double> jittered = joined(run_of(0, 0.05, 100), run_of(0, 0.05, 100));
    for (std::size_t begin = 0; begin < 200; begin += 10)
      std::shuffle(&jittered[begin], &jittered[begin] + 10, random);
    EXPECT_EQ(find_restart(jittered), 100U) << trial;
  }
}

TEST(SetBackClock, IsAStepBackFromWhichTheStreamDoesNotComeUpAgain) {
  const std::vector<double> before = run_of(100, 0.1, 37);
  for (const double back : {1.5, 3.7, 4.0, 37.0, 3600.0})
    for (const int after : {1, 2, 3, 30})
      EXPECT_EQ(find_set_back(joined(before, run_of(103.7 - back, 0.1, after))),
                after > 2 && 0.1 * after < back - 0.05 ? std::optional<std::size_t>(37) : std::nullopt)
          << back << " s, " << after;
  EXPECT_EQ(find_set_back(joined(joined(before, run_of(60, 0.1, 9)), run_of(20, 0.1, 9))), 37U) << "twice";
  EXPECT_FALSE(find_set_back(joined(run_of(9000, 1, 1), before))) << "the first message alone";
  EXPECT_EQ(find_set_back(joined(run_of(22, 1, 3), run_of(10, 1, 12))), 3U) << "parts in another order";
}

TEST(SetBackClock, DisorderAndLateMessagesAreNone) {
  EXPECT_FALSE(find_set_back({}));
  EXPECT_FALSE(find_set_back(run_of(10, 0.1, 100)));
  EXPECT_FALSE(find_set_back(joined(run_of(10, 0.1, 50), run_of(14.2, 0.1, 5)))) << "0.7 s back";
  EXPECT_FALSE(find_set_back(joined(joined(run_of(50, 0.1, 50), run_of(20, 0.1, 3)), run_of(55, 0.1, 9))))
      << "late, and then it goes on";
  std::vector<double> late_at_the_end = run_of(0, 0.1, 40);
  for (const long i : {5, 18, 31})
    std::rotate(late_at_the_end.begin() + i, late_at_the_end.begin() + i + 1, late_at_the_end.end());
  EXPECT_FALSE(find_set_back(late_at_the_end)) << "what comes last lacks before";
  std::mt19937 random(6);
  for (const double step : {0.03, 0.1, 0.3, 1.5}) {
    std::vector<double> reversed = run_of(0, step, 100);
    std::reverse(reversed.begin(), reversed.end());
    EXPECT_FALSE(find_set_back(reversed)) << step;
    for (int trial = 0; trial < 300; ++trial) {
      std::vector<double> shuffled = run_of(0, step, 40 + trial);
      std::shuffle(shuffled.begin(), shuffled.end(), random);
      EXPECT_FALSE(find_set_back(shuffled)) << step << ", " << trial;
      std::vector<double> jittered = run_of(0, step, 200);
      for (double& time : jittered)
        time -= std::uniform_real_distribution<double>(0.0, 0.9)(random);  // of a buffer
      EXPECT_FALSE(find_set_back(jittered)) << step << ", " << trial;
    }
  }
}

}  // namespace clock_restart_test
}  // namespace clearway
