#include "apps/results/compare_summary.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <nlohmann/json.hpp>
#include <string>

#include "apps/results/compare_columns.hpp"
#include "apps/results/compare_results.hpp"

namespace clearway {
namespace compare_summary_test {

/// A run of a team that had to keep 5 cm, and how near the check saw it come.
CompareRun team_run(const std::string& check, double separation, double step_bound,
                    double acceleration = 1.0) {
  CompareRun run;
  run.status = check == "outrun" ? PlanStatus::no_path : PlanStatus::solved;
  run.check = check;
  run.min_clearance = separation;
  run.team.emplace();
  run.team->security_distance = 0.05;
  run.team->step_bound = step_bound;
  run.motion = {4.0, 0.9, acceleration};
  return run;
}

CompareExperiment experiment_of(const std::vector<CompareRun>& runs) {
  CompareExperiment experiment;
  experiment.setup.teams.emplace();
  experiment.planners.push_back({"local", "local", {}, true});
  experiment.problems.push_back({});
  experiment.problems.back().runs = runs;
  return experiment;
}

TEST(CompareSummaryOfTeams, ATeamFallsShortByWhatItCameNearerThanItsSecurityDistance) {
  const CompareExperiment experiment = experiment_of(
      {team_run("valid", 0.06, 0.002), team_run("refused", 0.02, 0.004), team_run("valid", 0.047, 0.001),
       team_run("outrun", 0.001, 0.1, 9.0),  // no promise, no shortfall
       team_run("none", 0.0, 0.1), team_run("valid", 0.07, 0.001, 7.4)});
  const CompareSummary sum = summary(experiment, 0);
  EXPECT_NEAR(sum.worst_shortfall, 0.03, 1e-15);
  EXPECT_EQ(sum.least_separation, 0.02);
  EXPECT_EQ(sum.allowed_shortfall, 0.004);
  EXPECT_EQ(sum.top_acceleration, 7.4);
  EXPECT_EQ(sum.safe, 3U);
  EXPECT_EQ(sum.refused, 1U);
  EXPECT_EQ(sum.outrun, 1U);
  const nlohmann::ordered_json json = summary_json(experiment, 0);
  EXPECT_NEAR(json["below_security_distance_m"].get<double>(), 0.03, 1e-15);
  EXPECT_EQ(json["least_separation_m"], 0.02);
  EXPECT_EQ(json["allowed_below_m"], 0.004);
  EXPECT_EQ(json["top_acceleration_share"], 7.4);
}

TEST(CompareSummaryOfTeams, ATeamThatKeptItsDistanceFallsShortByNothing) {
  const CompareSummary far =
      summary(experiment_of({team_run("valid", 0.06, 0.0), team_run("valid", 2.0, 0.0)}), 0);
  EXPECT_EQ(far.worst_shortfall, 0.0);
  EXPECT_EQ(far.least_separation, 0.06);
  const CompareSummary none = summary(experiment_of({}), 0);
  EXPECT_EQ(none.worst_shortfall, 0.0);
  EXPECT_TRUE(std::isnan(none.least_separation));
}

TEST(CompareSummary, ReportsMediansOfValidRunsAndTimesOfSolvedOnes) {
  std::vector<CompareRun> runs;
  for (int i = 1; i <= 5; ++i) {  // 1, 4, 9, 16, 25
    CompareRun run;
    run.status = PlanStatus::solved;
    run.check = i < 5 ? "valid" : "refused";
    run.time = i * i;
    run.cpu = 2.0 * i * i;
    run.check_cpu = 3.0 * i * i;
    run.space_cpu = 4.0 * i * i;
    run.derive_cpu = 0.5 * i * i;
    if (i < 5) run.work = {.search = 1.5 * i * i, .proofs = 0.5 * i * i};  // the fifth is not split
    if (i == 4) run.work.shortcuts = 8.0, run.work.search = 16.0;
    run.cost = 10.0 * i * i;
    run.length = 100.0 * i * i;
    run.steps = static_cast<std::size_t>(7 * i * i);
    run.motion = CompareMotion{1000.0 * i * i, 0.5, 0.5};
    runs.push_back(run);
  }
  runs.push_back({});  // no path
  CompareExperiment experiment = experiment_of(runs);
  experiment.setup.teams.reset();
  const CompareSummary sum = summary(experiment, 0);
  EXPECT_EQ(sum.solved, 5U);
  EXPECT_EQ(sum.valid, 4U);
  EXPECT_DOUBLE_EQ(sum.time_median, 9.0);
  EXPECT_DOUBLE_EQ(sum.cpu_median, 18.0);
  EXPECT_DOUBLE_EQ(sum.check_median, 27.0);
  EXPECT_EQ(sum.work_mean.search, (1.5 * 14 + 16.0) / 4);
  EXPECT_EQ(sum.work_mean.shortcuts, 8.0 / 4);
  EXPECT_EQ(sum.work_mean.proofs, 0.5 * 30 / 4);
  EXPECT_EQ(work_text(sum), "62 / 13 / 25");
  EXPECT_DOUBLE_EQ(sum.space_mean, 4.5 * 55 / 5);
  EXPECT_DOUBLE_EQ(sum.check_mean, 3.0 * 55 / 5);
  EXPECT_GT(sum.time_p95, 20.0);
  EXPECT_LE(sum.time_p95, 25.0);
  const double middle = 6.5;  // of 1, 4, 9, 16
  EXPECT_DOUBLE_EQ(sum.cost_median, 10.0 * middle);
  EXPECT_DOUBLE_EQ(sum.length_median, 100.0 * middle);
  EXPECT_DOUBLE_EQ(sum.steps_median, 7.0 * middle);
  EXPECT_DOUBLE_EQ(sum.motion_median, 1000.0 * middle);
  const nlohmann::ordered_json json = summary_json(experiment, 0);
  const std::map<std::string, double> told{{"time_median_s", 9.0},
                                           {"cpu_median_s", 18.0},
                                           {"check_cpu_median_s", 27.0},
                                           {"space_cpu_mean_s", 4.5 * 55 / 5},
                                           {"search_cpu_mean_s", (1.5 * 14 + 16.0) / 4},
                                           {"shortcut_cpu_mean_s", 8.0 / 4},
                                           {"proof_cpu_mean_s", 0.5 * 30 / 4},
                                           {"check_cpu_mean_s", 3.0 * 55 / 5}};
  for (const auto& [key, value] : told) EXPECT_DOUBLE_EQ(json.at(key).get<double>(), value) << key;
}

/// Only of runs that are valid: a path that is none is not ridden at all.
TEST(CompareSummary, CountsValidRunsThatGoEdgeByEdge) {
  std::vector<CompareRun> runs;
  for (const char* check : {"valid", "refused", "none"}) {
    for (const char* note : {"a limit is missing", "", "a limit is missing"}) {
      CompareRun run;
      run.status = PlanStatus::solved;
      run.check = check;
      run.motion = {4.0, 0.9, 0.9};
      run.motion->note = note;
      runs.push_back(run);
      run.motion.reset();
      runs.push_back(run);
    }
  }
  CompareExperiment experiment = experiment_of(runs);
  experiment.setup.teams.reset();
  EXPECT_EQ(summary(experiment, 0).edge_by_edge, 2U);
  EXPECT_EQ(summary_json(experiment, 0)["edge_by_edge"], 2);
}

CompareResults hand_made() {
  CompareResults results;
  CompareExperiment experiment;
  experiment.setup.name = "e";
  experiment.planners = {{"sure", "beam", {}, true}, {"unsure", "rrtconnect_fcl", {}, false}};
  for (int i = 1; i <= 20; ++i) {
    CompareProblem problem;
    problem.name = "p" + std::to_string(i);
    for (std::size_t planner = 0; planner < 2; ++planner) {
      CompareRun run;
      run.planner = planner;
      run.status = i <= 18 ? PlanStatus::solved : PlanStatus::no_path;
      run.check = i <= 18 ? "valid" : "none";
      run.time = 21 - i;
      run.cost = i;
      problem.runs.push_back(run);
    }
    experiment.problems.push_back(problem);
  }
  results.experiments.push_back(experiment);
  return results;
}

TEST(CompareSummary, IsOfSolvedRunsForTimesAndOfValidOnesForCosts) {
  CompareResults results = hand_made();
  results.experiments[0].problems[0].runs[0].check = "refused";
  const CompareSummary sum = summary(results.experiments[0], 0);
  EXPECT_EQ(sum.solved, 18U);
  EXPECT_EQ(sum.valid, 17U);
  EXPECT_EQ(sum.total, 20U);
  EXPECT_EQ(sum.time_median, 11.5);  // of 3 … 20
  EXPECT_DOUBLE_EQ(sum.time_p95, 19.15);
  EXPECT_EQ(sum.cost_median, 10.0);  // of 2 … 18
  EXPECT_EQ(sum.unsolved, (std::map<std::string, std::size_t>{{"no_path", 2}}));
}

/// A planner without randomness: the same answer for each of four seeds.
TEST(CompareSummary, ACostThatIsNotKnownIsNoFigure) {
  CompareExperiment experiment;
  experiment.planners = {{"one", "beam", {}, true}};
  for (const double cost : {4.0, std::nan(""), 8.0}) {
    CompareRun run;
    run.status = PlanStatus::solved;
    run.check = "valid";
    run.cost = cost;
    experiment.problems.emplace_back().runs = {run};
  }
  EXPECT_EQ(summary(experiment, 0).cost_median, 6.0);
  for (CompareProblem& problem : experiment.problems) problem.runs[0].cost = std::nan("");
  EXPECT_TRUE(std::isnan(summary(experiment, 0).cost_median));
  const std::vector<RunColumn> columns = run_columns();
  const auto column = std::find_if(columns.begin(), columns.end(),
                                   [](const RunColumn& each) { return each.name == "cost_joules"; });
  ASSERT_NE(column, columns.end());
  EXPECT_TRUE(std::holds_alternative<std::monostate>(
      column->cell(experiment.problems[0].runs[0], experiment.planners[0])));
}

TEST(CompareSummary, IntervalsAreOfProblemsAndNotOfSeeds) {
  CompareResults results;
  CompareExperiment& experiment = results.experiments.emplace_back();
  experiment.planners = {{"boundary", "boundary", {}, true}};
  for (int i = 0; i < 6; ++i) {
    CompareProblem& problem = experiment.problems.emplace_back();
    for (int number = 1; number <= 4; ++number) {
      CompareRun& run = problem.runs.emplace_back();
      run.number = number;
      run.status = i == 0 ? PlanStatus::solved : PlanStatus::no_path;
      run.check = i == 0 ? "valid" : "none";
    }
  }
  const CompareSummary sum = summary(experiment, 0);
  EXPECT_EQ(sum.problems, 6U);
  EXPECT_EQ(sum.effective_runs, 6.0);
  EXPECT_EQ(success_text(sum), "16.7 (3.01 to 56.4)");
  const nlohmann::ordered_json json = summary_json(experiment, 0);
  EXPECT_EQ(json["problems"], 6);
  EXPECT_EQ(json["effective_runs"], 6.0);
  EXPECT_NEAR(json["valid_share_95"][1].get<double>(), 0.5635, 5e-5);
}

TEST(CompareSummary, OnlyThosePromisesAreBrokenThatWereMade) {
  CompareResults results = hand_made();
  EXPECT_TRUE(broken_promises(results).empty());
  results.experiments[0].problems[4].runs[1].check = "refused";
  EXPECT_TRUE(broken_promises(results).empty());
  results.experiments[0].problems[4].runs[0].check = "undecided";
  const auto sentences = broken_promises(results);
  ASSERT_EQ(sentences.size(), 1U);
  EXPECT_NE(sentences[0].find("problem 'p5': 'sure' promises"), std::string::npos) << sentences[0];
}

}  // namespace compare_summary_test
}  // namespace clearway
