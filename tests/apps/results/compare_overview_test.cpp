#include "apps/results/compare_overview.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>
#include <random>

namespace clearway {
namespace compare_overview_test {

/// Experiments `sizes[e]` problems large, each problem with two seeds; planner 0 and 1 in all of them,
/// planner 2 in the last alone.
CompareResults drawn(const std::vector<std::size_t>& sizes) {
  std::mt19937 dice(7);
  CompareResults results;
  for (std::size_t e = 0; e < sizes.size(); ++e) {
    CompareExperiment experiment;
    experiment.setup.name = "e" + std::to_string(e);
    experiment.planners = {{"a", "beam", {}, true}, {"b", "rrtconnect", {}, true}};
    if (e + 1 == sizes.size()) experiment.planners.push_back({"last", "rrtconnect_fcl", {}, false});
    for (std::size_t i = 0; i < sizes[e]; ++i) {
      CompareProblem problem;
      for (std::size_t p = 0; p < experiment.planners.size(); ++p) {
        for (int number = 1; number <= 2; ++number) {
          CompareRun run;
          run.planner = p;
          run.number = number;
          run.status = dice() % 4 == 0 ? PlanStatus::timed_out : PlanStatus::solved;
          run.check = run.is_solved() ? (dice() % 5 == 0 ? "refused" : "valid") : "none";
          run.time = 1e-3 * static_cast<double>(dice() % 100000);
          run.cpu = 0.5 * run.time;
          run.cost = static_cast<double>(dice() % 1000);
          run.length = static_cast<double>(dice() % 77);
          problem.runs.push_back(run);
        }
      }
      experiment.problems.push_back(problem);
    }
    results.experiments.push_back(experiment);
  }
  return results;
}

/// Of which so large a share of the ways between neighbours is below: 0.5 is the median.
double linear_quantile(std::vector<double> values, double share) {
  std::sort(values.begin(), values.end());
  double left = share * static_cast<double>(values.size() - 1), found = values[0];
  for (std::size_t i = 1; i < values.size() && left > 0.0; ++i, left -= 1.0)
    found += std::min(left, 1.0) * (values[i] - values[i - 1]);
  return found;
}

/// One table of all runs, as in results.csv.
struct FlatRun {
  std::string label;
  std::size_t experiment, problem;
  CompareRun run;
};

std::vector<FlatRun> flat(const CompareResults& results) {
  std::vector<FlatRun> runs;
  for (std::size_t e = 0; e < results.experiments.size(); ++e)
    for (std::size_t i = 0; i < results.experiments[e].problems.size(); ++i)
      for (const CompareRun& run : results.experiments[e].problems[i].runs)
        runs.push_back({results.experiments[e].planners[run.planner].label, e, i, run});
  return runs;
}

void expect_row(const OverviewRow& row, const std::vector<FlatRun>& runs) {
  std::vector<double> times, cpus;
  std::size_t solved = 0, valid = 0, total = 0;
  for (const FlatRun& each : runs) {
    if (each.label != row.who.label) continue;
    ++total;
    if (each.run.status != PlanStatus::solved) continue;
    ++solved;
    valid += each.run.check == "valid";
    times.push_back(each.run.time);
    cpus.push_back(each.run.cpu);
  }
  EXPECT_EQ(row.all.total, total);
  EXPECT_EQ(row.all.solved, solved);
  EXPECT_EQ(row.all.valid, valid);
  EXPECT_NEAR(row.all.time_median, linear_quantile(times, 0.5), 1e-9);
  EXPECT_NEAR(row.all.time_p95, linear_quantile(times, 0.95), 1e-9);
  EXPECT_NEAR(row.all.cpu_median, linear_quantile(cpus, 0.5), 1e-9);
}

bool is_valid_for(const std::vector<FlatRun>& runs, const FlatRun& like, const std::string& label) {
  return std::any_of(runs.begin(), runs.end(), [&](const FlatRun& each) {
    return each.label == label && each.experiment == like.experiment && each.problem == like.problem &&
           each.run.number == like.run.number && each.run.is_valid();
  });
}

TEST(CompareOverview, SumsEveryRunOfALabelWhateverTheExperiment) {
  const CompareResults results = drawn({7, 13, 20});
  const CompareOverview all = overview(results);
  ASSERT_EQ(all.planners.size(), 3U);
  EXPECT_EQ(all.runs, 2U * 40U);
  EXPECT_EQ(all.experiments, 3U);
  for (const OverviewRow& row : all.planners) expect_row(row, flat(results));
}

TEST(CompareOverview, PathsHaveTheUnitOfTheirJoints) {
  CompareResults results = drawn({7, 13});
  results.experiments[0].is_prismatic = {false, false};
  results.experiments[1].is_prismatic = {false, false};
  EXPECT_EQ(overview(results).length_unit, "rad");
  results.experiments[0].is_prismatic = {false, true};
  EXPECT_EQ(length_unit(results.experiments[0]), "rad and m");
  EXPECT_EQ(overview(results).length_unit, "rad or m");
  results.experiments[0].is_prismatic = results.experiments[1].is_prismatic = {true};
  EXPECT_EQ(overview_table(overview(results))[0][9], "length m");
}

TEST(CompareOverview, OnlyPlannersThatRanAllOfItAreComparable) {
  const CompareOverview all = overview(drawn({7, 13, 20}));
  EXPECT_TRUE(all.planners[0].is_comparable);
  EXPECT_TRUE(all.planners[1].is_comparable);
  EXPECT_EQ(all.planners[2].who.label, "last");
  EXPECT_FALSE(all.planners[2].is_comparable);
  EXPECT_EQ(all.planners[2].experiments, 1U);
  EXPECT_TRUE(std::isnan(all.planners[2].shared.time_median));
  const auto table = overview_table(all);
  EXPECT_EQ(table[3][0], "last *");
  EXPECT_EQ(table[3][1], "1 of 3");
}

TEST(CompareOverview, SharedFiguresAreOfTheRunsThatAllComparablePlannersSolved) {
  const CompareResults results = drawn({7, 13, 20});
  const CompareOverview all = overview(results);
  const std::vector<FlatRun> runs = flat(results);
  for (std::size_t p = 0; p < 2; ++p) {
    std::vector<double> times, costs, lengths;
    for (const FlatRun& each : runs) {
      if (each.label != all.planners[p].who.label) continue;
      if (!is_valid_for(runs, each, "a") || !is_valid_for(runs, each, "b")) continue;
      times.push_back(each.run.time);
      costs.push_back(each.run.cost);
      lengths.push_back(each.run.length);
    }
    EXPECT_GT(times.size(), 10U);
    EXPECT_LT(times.size(), 80U);
    EXPECT_EQ(all.shared, times.size());
    EXPECT_NEAR(all.planners[p].shared.time_median, linear_quantile(times, 0.5), 1e-9);
    EXPECT_NEAR(all.planners[p].shared.cost_median, linear_quantile(costs, 0.5), 1e-9);
    EXPECT_NEAR(all.planners[p].shared.length_median, linear_quantile(lengths, 0.5), 1e-9);
  }
}

/// Two experiments of one problem at two resolutions, two seeds each: one problem, whatever it is called.
TEST(CompareOverview, AProblemAtSeveralResolutionsIsOne) {
  CompareResults results = drawn({5, 5});
  EXPECT_EQ(overview(results).planners[0].all.problems, 10U);
  for (CompareExperiment& experiment : results.experiments) experiment.setup.alike = "all";
  const OverviewRow row = overview(results).planners[0];
  EXPECT_EQ(row.all.problems, 5U);
  EXPECT_EQ(row.all.total, 20U);
  EXPECT_LE(row.all.effective_runs, 20.0);
  EXPECT_GE(row.all.effective_runs, 5.0);
}

TEST(CompareOverview, AnInterruptedPlannerIsNotComparedAndExperimentsNotBegunAreNotCounted) {
  CompareResults results = drawn({3, 4, 0, 0});
  std::vector<CompareRun>& last = results.experiments[1].problems.back().runs;
  std::erase_if(last, [](const CompareRun& run) { return run.planner == 1; });
  const CompareOverview all = overview(results);
  EXPECT_EQ(all.experiments, 2U);
  EXPECT_EQ(all.without_runs, 2U);
  ASSERT_EQ(all.planners.size(), 2U) << "nobody ran the planner of the last experiment";
  EXPECT_EQ(all.planners[0].who.label, "a");
  EXPECT_TRUE(all.planners[0].is_comparable);
  EXPECT_EQ(all.planners[1].experiments, 2U);
  EXPECT_FALSE(all.planners[1].is_comparable);
  EXPECT_EQ(all.planners[1].all.total, 12U);
  const std::vector<std::string> notes = overview_notes(all);
  EXPECT_NE(std::find(notes.begin(), notes.end(), "Not begun: 2 experiments."), notes.end());
}

TEST(CompareOverview, LabelsWithDifferentOptionsSayThatTheyDiffer) {
  CompareResults results = drawn({2, 2});
  results.experiments[1].planners[0].options["width"] = "3";
  const CompareOverview all = overview(results);
  EXPECT_FALSE(all.planners[0].has_same_options);
  EXPECT_TRUE(all.planners[1].has_same_options);
  EXPECT_EQ(overview_notes(all).back(), "Planner or options differ between experiments: a.");
  const nlohmann::ordered_json json = overview_json(all);
  EXPECT_EQ(json["planners"][0]["same_options"], false);
  EXPECT_EQ(json["planners"][2]["comparable"], false);
}

TEST(CompareOverview, AddsNothingUpOfOneExperimentOrOfTeams) {
  EXPECT_TRUE(overview_table(overview(drawn({5}))).empty());
  EXPECT_TRUE(overview_json(overview(drawn({5}))).is_null());
  CompareResults teams = drawn({5, 5});
  for (CompareExperiment& experiment : teams.experiments) experiment.setup.teams.emplace();
  EXPECT_FALSE(overview(teams).adds_up());
  EXPECT_EQ(overview(teams).teams, 2U);
}

}  // namespace compare_overview_test
}  // namespace clearway
