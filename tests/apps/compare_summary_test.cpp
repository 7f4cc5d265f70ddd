#include "apps/compare_summary.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <nlohmann/json.hpp>

namespace clearway {
namespace {

/// A run of a team that had to keep 5 cm, and how near the check saw it come.
CompareRun team_run(const std::string& check, double separation, double step_bound) {
  CompareRun run;
  run.status = check == "outrun" ? PlanStatus::no_path : PlanStatus::solved;
  run.check = check;
  run.min_clearance = separation;
  run.team.emplace();
  run.team->security_distance = 0.05;
  run.team->step_bound = step_bound;
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
       team_run("outrun", 0.001, 0.1),  // no promise, no shortfall
       team_run("none", 0.0, 0.1)});
  const CompareSummary sum = summary(experiment, 0);
  EXPECT_NEAR(sum.worst_shortfall, 0.03, 1e-15);
  EXPECT_EQ(sum.least_separation, 0.02);
  EXPECT_EQ(sum.allowed_shortfall, 0.004);
  EXPECT_EQ(sum.safe, 2U);
  EXPECT_EQ(sum.refused, 1U);
  EXPECT_EQ(sum.outrun, 1U);
  const nlohmann::ordered_json json = summary_json(experiment, 0);
  EXPECT_NEAR(json["below_security_distance_m"].get<double>(), 0.03, 1e-15);
  EXPECT_EQ(json["least_separation_m"], 0.02);
  EXPECT_EQ(json["allowed_below_m"], 0.004);
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

}  // namespace
}  // namespace clearway
