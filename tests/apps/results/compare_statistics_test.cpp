#include "apps/results/compare_statistics.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <numeric>
#include <random>

namespace clearway {
namespace compare_statistics_test {

/// R. G. Newcombe 1998, Statistics in Medicine 17, p. 857, table I, method 3.
TEST(WilsonInterval, AgreesWithAPublishedTable) {
  struct Row {
    std::size_t successes, total;
    double low, high;
  };
  for (const Row& row : {Row{81, 263, 0.2553, 0.3662}, Row{15, 148, 0.0624, 0.1605}, Row{0, 20, 0.0, 0.1611},
                         Row{1, 29, 0.0061, 0.1718}}) {
    const double share = static_cast<double>(row.successes) / static_cast<double>(row.total);
    const auto [low, high] = wilson_interval(share, static_cast<double>(row.total));
    EXPECT_NEAR(low, row.low, 5e-5);
    EXPECT_NEAR(high, row.high, 5e-5);
    const auto [other_low, other_high] = wilson_interval(1.0 - share, static_cast<double>(row.total));
    EXPECT_NEAR(other_low, 1.0 - high, 1e-12);
    EXPECT_NEAR(other_high, 1.0 - low, 1e-12);
  }
  EXPECT_EQ(wilson_interval(0.0, 0.0), std::pair(0.0, 1.0));
}

std::vector<ProblemRuns> problems_of(std::initializer_list<std::size_t> valid, std::size_t total) {
  std::vector<ProblemRuns> problems;
  for (const std::size_t each : valid) problems.push_back({each, total});
  return problems;
}

TEST(EffectiveRuns, AreTheProblemsWhereAllSeedsAgreeAndTheRunsWhereEachProblemHasOne) {
  EXPECT_EQ(effective_runs(problems_of({4, 0, 0, 0, 0, 0}, 4)), 6.0);
  const auto [low, high] = wilson_interval(1.0 / 6.0, effective_runs(problems_of({4, 0, 0, 0, 0, 0}, 4)));
  EXPECT_NEAR(low, 0.030, 5e-4);  // Wilson's of 1 of 6
  EXPECT_NEAR(high, 0.564, 5e-4);
  EXPECT_EQ(effective_runs(problems_of({1, 0, 1, 1, 0}, 1)), 5.0);
  EXPECT_EQ(effective_runs(problems_of({4, 4, 4}, 4)), 3.0);
  EXPECT_EQ(effective_runs(problems_of({0, 0, 0}, 4)), 3.0);
  EXPECT_EQ(effective_runs(problems_of({12}, 24)), 1.0);
  EXPECT_EQ(effective_runs(problems_of({2, 2, 2, 2}, 4)), 16.0) << "no scatter between problems";
  EXPECT_EQ(effective_runs({}), 0.0);
  EXPECT_EQ(effective_runs({{0, 0}, {0, 0}}), 0.0);
  EXPECT_EQ(effective_runs({{2, 2}, {0, 0}, {3, 3}}), 25.0 / 13.0) << "interrupted: (sum m)^2 / sum m^2";
}

/// Korn and Graubard's figure, written out: six problems of four runs, t of 23 and of 5 degrees of freedom.
TEST(EffectiveRuns, AreTheSizeOfASampleOfClusters) {
  const auto written_out = [](std::initializer_list<std::size_t> valid) {
    double sum = 0.0, scatter = 0.0;
    for (const std::size_t y : valid) sum += static_cast<double>(y);
    const double share = sum / 24.0;
    for (const std::size_t y : valid) scatter += std::pow(static_cast<double>(y) - 4.0 * share, 2);
    const double variance = 6.0 / 5.0 * scatter / (24.0 * 24.0);
    return share * (1.0 - share) / variance * std::pow(2.068658 / 2.570582, 2);
  };
  EXPECT_NEAR(effective_runs(problems_of({4, 1, 2, 4, 1, 1}, 4)), written_out({4, 1, 2, 4, 1, 1}), 0.02);
  EXPECT_GT(written_out({4, 1, 2, 4, 1, 1}), 6.0);
  EXPECT_GT(written_out({3, 1, 2, 3, 2, 2}), 24.0);
  EXPECT_EQ(effective_runs(problems_of({3, 1, 2, 3, 2, 2}, 4)), 24.0) << "no more than there are";
  EXPECT_LT(written_out({4, 0, 4, 4, 0, 1}), 6.0);
  EXPECT_EQ(effective_runs(problems_of({4, 0, 4, 4, 0, 1}, 4)), 6.0) << "no fewer than the problems";
}

/// Problems of a beta distribution of difficulty, so that seeds agree more or less: of so many samples, the
/// share whose interval holds the truth. Wilson's of all runs holds it in 32 to 96 %.
TEST(EffectiveRuns, MakeIntervalsThatHoldTheTruthHoweverMuchSeedsAgree) {
  std::mt19937 dice(11);
  for (const auto& [problems, seeds] : {std::pair{6, 4}, {6, 10}, {20, 5}, {40, 1}})
    for (const double correlation : {0.02, 0.3, 0.7, 0.98}) {
      int held = 0, all = 0;
      for (const double truth : {0.25, 0.5, 0.7}) {
        const double strength = (1.0 - correlation) / correlation;
        std::gamma_distribution<double> first(truth * strength), second((1.0 - truth) * strength);
        for (int sample = 0; sample < 1000; ++sample, ++all) {
          std::vector<ProblemRuns> drawn;
          std::size_t valid = 0;
          for (int i = 0; i < problems; ++i) {
            const double a = first(dice), b = second(dice);
            std::binomial_distribution<int> runs(seeds, a + b > 0.0 ? a / (a + b) : 0.0);
            drawn.push_back({static_cast<std::size_t>(runs(dice)), static_cast<std::size_t>(seeds)});
            valid += drawn.back().valid;
          }
          const auto [low, high] =
              wilson_interval(static_cast<double>(valid) / (problems * seeds), effective_runs(drawn));
          held += low <= truth && truth <= high;
        }
      }
      EXPECT_GE(held, 0.925 * all) << problems << " " << seeds << " " << correlation;
      EXPECT_LE(held, 0.995 * all) << problems << " " << seeds << " " << correlation;
    }
}

/// Over all signs of so many coins.
double enumerated_sign_test(unsigned more, unsigned fewer) {
  const unsigned n = more + fewer, least = std::min(more, fewer);
  unsigned count = 0;
  for (unsigned signs = 0; signs < 1U << n; ++signs) {
    const auto heads = static_cast<unsigned>(__builtin_popcount(signs));
    count += std::min(heads, n - heads) <= least;
  }
  return static_cast<double>(count) / static_cast<double>(1U << n);
}

TEST(SignTest, IsTheShareOfAllOutcomesThatAreAsFarApart) {
  for (unsigned more = 0; more <= 8; ++more)
    for (unsigned fewer = 0; fewer <= 8; ++fewer)
      EXPECT_NEAR(sign_test(more, fewer), enumerated_sign_test(more, fewer), 1e-12) << more << " " << fewer;
  EXPECT_EQ(sign_test(0, 0), 1.0);
  EXPECT_LT(sign_test(1000, 0), 1e-300);
}

/// Over all signs of the sizes, with ranks found by counting.
double enumerated_signed_rank_test(const std::vector<double>& differences) {
  std::vector<double> ranks;
  double given = 0.0;
  for (const double a : differences) {
    double below = 0.0, same = 0.0;
    for (const double b : differences) {
      below += std::abs(b) < std::abs(a);
      same += std::abs(b) == std::abs(a);
    }
    ranks.push_back(below + 0.5 * (same + 1.0));
    if (a > 0.0) given += ranks.back();
  }
  const double all = std::accumulate(ranks.begin(), ranks.end(), 0.0);
  unsigned count = 0;
  for (unsigned signs = 0; signs < 1U << ranks.size(); ++signs) {
    double sum = 0.0;
    for (std::size_t i = 0; i < ranks.size(); ++i) sum += (signs >> i & 1U) != 0 ? ranks[i] : 0.0;
    count += std::min(sum, all - sum) <= std::min(given, all - given);
  }
  return static_cast<double>(count) / static_cast<double>(1U << ranks.size());
}

TEST(SignedRankTest, IsTheShareOfAllSignsThatAreAsFarApartTiesIncluded) {
  std::mt19937 dice(7);
  for (int round = 0; round < 60; ++round) {
    std::vector<double> differences(1 + dice() % 12);
    for (double& value : differences) {
      value = 1.0 + static_cast<double>(dice() % (round % 2 == 0 ? 4 : 1000));  // few sizes: ties
      if (dice() % 3 == 0) value = -value;
    }
    EXPECT_NEAR(signed_rank_test(differences), enumerated_signed_rank_test(differences), 1e-12);
    differences.push_back(0.0);
    EXPECT_NEAR(signed_rank_test(differences),
                enumerated_signed_rank_test({differences.begin(), differences.end() - 1}), 1e-12);
  }
  EXPECT_EQ(signed_rank_test({}), 1.0);
  EXPECT_EQ(signed_rank_test({0.0, 0.0}), 1.0);
}

/// Critical values of T at 5 %, two-sided (Wilcoxon's table): p is at most 0.05 there, and above it at T + 1.
TEST(SignedRankTest, AgreesWithTheTableOfCriticalValues) {
  for (const auto& [n, critical] : {std::pair{6, 0}, {7, 2}, {8, 3}, {10, 8}, {15, 25}, {20, 52}, {25, 89}}) {
    const auto p_of = [n = n](int t) {
      std::vector<double> differences;
      for (int rank = n; rank >= 1; --rank) {
        const bool is_negative = rank <= t;
        if (is_negative) t -= rank;
        differences.push_back(is_negative ? -rank : rank);
      }
      return signed_rank_test(differences);
    };
    EXPECT_LE(p_of(critical), 0.05) << n;
    EXPECT_GT(p_of(critical + 1), 0.05) << n;
  }
}

TEST(SignedRankTest, IsNearlyExactWhereItIsApproximated) {
  std::vector<double> differences;
  for (int rank = 1; rank <= 100; ++rank) differences.push_back(rank % 3 == 0 ? -rank : rank);
  const double exact = signed_rank_test(differences);
  differences.push_back(1e-9);  // rank 1 of 101: all other ranks move up by one
  EXPECT_NEAR(signed_rank_test(differences), exact, 0.15 * exact);
}

TEST(HolmCorrection, MultipliesTheSmallestByTheirNumberAndKeepsTheOrder) {
  const auto corrected = holm_corrected({0.01, 0.04, 0.03, 0.005});
  ASSERT_EQ(corrected.size(), 4U);
  EXPECT_NEAR(corrected[0], 0.03, 1e-12);
  EXPECT_NEAR(corrected[1], 0.06, 1e-12);
  EXPECT_NEAR(corrected[2], 0.06, 1e-12);
  EXPECT_NEAR(corrected[3], 0.02, 1e-12);
  EXPECT_EQ(holm_corrected({0.9, 0.8}), (std::vector<double>{1.0, 1.0}));
  EXPECT_TRUE(holm_corrected({}).empty());
}

/// Two planners on 20 problems, twice each: the first solves all, the second 10, for three times the CPU.
TEST(PairedPlanners, ComparesProblemByProblemInWords) {
  CompareExperiment experiment;
  experiment.planners = {{"sure", "a", {}, true}, {"slow", "b", {}, true}};
  for (int i = 0; i < 20; ++i) {
    CompareProblem& problem = experiment.problems.emplace_back();
    for (std::size_t planner = 0; planner < 2; ++planner) {
      for (int number = 1; number <= 2; ++number) {
        CompareRun run;
        run.planner = planner;
        run.number = number;
        run.status = planner == 0 || i < 10 ? PlanStatus::solved : PlanStatus::no_path;
        run.check = run.is_solved() ? "valid" : "none";
        run.cpu = (planner == 0 ? 1.0 : 3.0) * (1.0 + i);
        run.cost = 5.0;
        problem.runs.push_back(run);
      }
    }
  }
  const auto pairs = paired_planners(experiment);
  ASSERT_EQ(pairs.size(), 1U);
  EXPECT_EQ(pairs[0].first_more, 10U);
  EXPECT_EQ(pairs[0].second_more, 0U);
  EXPECT_NEAR(pairs[0].success_p, 2.0 / 1024.0, 1e-12);
  EXPECT_EQ(pairs[0].cpu.problems, 10U);
  EXPECT_NEAR(pairs[0].cpu.ratio, 1.0 / 3.0, 1e-12);
  EXPECT_NEAR(pairs[0].cpu.p, 2.0 / 1024.0, 1e-12);
  EXPECT_EQ(pairs[0].cost.p, 1.0);
  for (CompareProblem& problem : experiment.problems)
    for (CompareRun& run : problem.runs)
      if (run.planner == 0) run.cost *= 1.0 + 4e-16;
  EXPECT_EQ(paired_planners(experiment)[0].words, pairs[0].words);  // rounding
  for (CompareProblem& problem : experiment.problems)
    for (CompareRun& run : problem.runs)
      if (run.planner == 0) run.cost *= 1.0002;
  EXPECT_NE(paired_planners(experiment)[0].words.find(
                " The median of path cost is the same to a thousandth, with and without "
                "those that are equal (10 problems that both solve, p = 0.002)."),
            std::string::npos)
      << paired_planners(experiment)[0].words;
  EXPECT_EQ(
      pairs[0].words,
      "sure solves more (10 of 10 problems on which they differ, p = 0.002). sure needs 33.33 % of slow's "
      "CPU time (median over 10 problems that both solve, p = 0.002). No difference in path cost beyond "
      "chance (10 problems that both solve, p = 1).");
  for (CompareProblem& problem : experiment.problems)
    for (CompareRun& run : problem.runs) run.check = "none";
  EXPECT_EQ(paired_planners(experiment)[0].words, "Neither solves a problem.");
}

}  // namespace compare_statistics_test
}  // namespace clearway
