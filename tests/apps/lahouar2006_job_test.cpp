// What Lahouar et al. 2006 show in Figs. 4, 5, 11 and 12, in the committed experiments; Figs. 13 and 14 are
// in tests/planning/team/team_test.cpp, and here only as the suite has them.

#include <gtest/gtest.h>

#include <filesystem>

#include "apps/compare/compare_run.hpp"

namespace clearway {
namespace lahouar2006_job_test {

/// An experiment of the suite, run whole, judged by the independent check.
CompareExperiment run_of(const std::string& name, const std::filesystem::path& out) {
  const Suite suite =
      load_suite(std::filesystem::path(CLEARWAY_SOURCE_DIR) / "datasets/suites/lahouar2006.yaml");
  for (const SuiteExperiment& experiment : suite.experiments) {
    if (experiment.name != name) continue;
    SuiteExperiment plain = experiment;
    plain.plots.clear();
    return run_experiment(suite, prepare(suite, plain, {}), {.seed = 1, .jobs = 2, .out = out});
  }
  throw std::logic_error("no experiment " + name);
}

class Lahouar2006 : public testing::TestWithParam<const char*> {
 protected:
  void SetUp() override { std::filesystem::create_directories(out_); }
  void TearDown() override { std::filesystem::remove_all(out_); }
  const std::filesystem::path out_ =
      std::filesystem::path(testing::TempDir()) / (std::string("lahouar2006_") + GetParam());
};

TEST_P(Lahouar2006, BoundaryFollowingArrivesWhereTheLocalMethodAloneDoesNot) {
  const CompareExperiment experiment = run_of(GetParam(), out_);
  ASSERT_EQ(experiment.problems.size(), 1U);
  ASSERT_GE(experiment.problems[0].runs.size(), 3U);
  for (const CompareRun& run : experiment.problems[0].runs) {
    const ComparePlanner& who = experiment.planners[run.planner];
    SCOPED_TRACE(who.label + ": " + run.explanation);
    if (who.planner == "constraint" || std::string(GetParam()) == "figure4") {
      EXPECT_EQ(run.status, PlanStatus::no_path);
    } else {
      EXPECT_TRUE(run.is_valid()) << run.contact;
    }
    if (who.planner == "constraint") {
      EXPECT_NE(run.explanation.find(run.team ? "No robot moves any more" : "Deadlock"), std::string::npos);
    } else if (std::string(GetParam()) == "figure4") {
      EXPECT_NE(run.explanation.find("came back to the deadlock point"), std::string::npos);
    }
  }
}

INSTANTIATE_TEST_SUITE_P(Figures, Lahouar2006,
                         testing::Values("figure4", "figure5", "figure11", "figure12", "figure13",
                                         "figure14"));

}  // namespace lahouar2006_job_test
}  // namespace clearway
