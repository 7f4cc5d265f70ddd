// datasets/suites/sensed.yaml, run as `clearway compare` runs it, with one planner each and shorter where
// that shows as much: arms among furniture and in paint while sensors change the map.

#include <gtest/gtest.h>

#include <filesystem>
#include <functional>

#include "apps/compare/compare_run.hpp"

namespace clearway {
namespace sensed_job_test {

using Change = std::function<void(SuiteExperiment&)>;

Suite sensed_suite() {
  return load_suite(std::filesystem::path(CLEARWAY_SOURCE_DIR) / "datasets/suites/sensed.yaml");
}

SuiteExperiment experiment_of(const Suite& suite, const std::string& name) {
  for (const SuiteExperiment& experiment : suite.experiments)
    if (experiment.name == name) return experiment;
  throw std::logic_error("no experiment " + name);
}

/// The runs of the experiment's teams led by `planner`, judged by the independent check.
std::vector<CompareRun> runs_of(const std::string& name, const std::string& planner,
                                const Change& change = {}) {
  const std::filesystem::path out = std::filesystem::path(testing::TempDir()) / ("sensed_" + name);
  const Suite suite = sensed_suite();
  SuiteExperiment experiment = experiment_of(suite, name);
  if (change) change(experiment);
  std::filesystem::create_directories(out);
  const CompareExperiment done =
      run_experiment(suite, prepare(suite, experiment, {planner}), {.seed = 1, .jobs = 2, .out = out});
  std::vector<CompareRun> runs;
  for (const CompareProblem& problem : done.problems) {
    EXPECT_TRUE(std::filesystem::exists(out / problem.page));
    EXPECT_EQ(problem.runs.size(), 1U);
    runs.push_back(problem.runs.at(0));
  }
  std::filesystem::remove_all(out);
  return runs;
}

CompareRun run_of(const std::string& name, const std::string& planner, const Change& change = {}) {
  return runs_of(name, planner, change).at(0);
}

/// Sensors that see no farther than this see nothing of what moves.
void blind(SuiteExperiment& experiment) { experiment.teams->sensing->range = 0.3; }

void expect_arrived(const CompareRun& run) {
  EXPECT_EQ(run.status, PlanStatus::solved) << run.explanation;
  EXPECT_EQ(run.check, "valid") << run.contact << run.team->outrun;
  EXPECT_GE(run.min_clearance, run.team->security_distance - run.team->step_bound);
  EXPECT_GT(run.min_clearance, 0.01);
}

/// The same robots run into what moves when nobody sees it, so that what is above can fail.
void expect_contact(const CompareRun& run, const std::string& with) {
  EXPECT_EQ(run.check, "refused");
  EXPECT_FALSE(run.is_valid());
  EXPECT_NE(run.contact.find(with), std::string::npos) << run.contact;
  EXPECT_NE(run.contact.find(" came within 0 mm"), std::string::npos) << run.contact;
}

TEST(Sensed, AnArmWaitsAtALoadedBenchForABoxThatStandsBetweenItAndItsGoal) {
  const CompareRun seen = run_of("bench", "constraint");
  expect_arrived(seen);
  EXPECT_GT(seen.motion->time, 15.0);  // the box leaves at 12 s
  expect_contact(run_of("bench", "constraint", blind), "box");
}

TEST(Sensed, AnArmInPaintWaitsUntilTheIntruderIsGoneAndSaysWhenOneIsTooFast) {
  const std::vector<CompareRun> seen = runs_of("paint", "constraint");
  ASSERT_EQ(seen.size(), 2U);
  expect_arrived(seen[0]);
  EXPECT_GT(seen[0].motion->time, 15.0);  // 12 s of way, and as long as the ball is there
  EXPECT_EQ(seen[1].check, "outrun");
  EXPECT_FALSE(seen[1].is_valid());
  EXPECT_NE(seen[1].team->outrun.find("what sensors saw"), std::string::npos) << seen[1].team->outrun;
  expect_contact(run_of("paint", "constraint", blind), "ball");
}

TEST(Sensed, TwoArmsGiveWayToWhatTheirSharedMapShows) {
  expect_arrived(run_of("shared", "constraint"));
  expect_contact(run_of("shared", "constraint", blind), "bar");
}

TEST(Sensed, ABoxArrivesWhileAnArmFollowsABoundary) {
  const CompareRun seen = run_of("post", "boundary");
  expect_arrived(seen);
  EXPECT_GT(seen.statistics.at("steps_boundary"), 10.0);
  expect_contact(run_of("post", "boundary", blind), "box");
}

TEST(Sensed, WhereTheLocalMethodAloneIsStuckItSaysSo) {
  const CompareRun stuck = run_of("post", "constraint", [](SuiteExperiment& experiment) {
    experiment.teams->teams[0].moving[0].path.resize(1);  // the box stays where it is, beside the way
  });
  EXPECT_EQ(stuck.status, PlanStatus::no_path) << stuck.explanation;
  EXPECT_NE(stuck.explanation.find("No robot moves any more"), std::string::npos) << stuck.explanation;
  EXPECT_EQ(stuck.check, "valid") << stuck.contact;
}

TEST(Sensed, SensorsThatCannotSeeAreReportedBeforeAnythingRuns) {
  const auto refusal = [](const Eigen::Vector3d& place) -> std::string {
    const Suite suite = sensed_suite();
    SuiteExperiment experiment = experiment_of(suite, "bench");
    experiment.teams->sensing->sensors.push_back(place);
    try {
      prepare(suite, experiment, {});
    } catch (const std::invalid_argument& error) {
      return error.what();
    }
    return "";
  };
  EXPECT_NE(refusal({0.9, 0.5, 0.265})
                .find("experiment 'bench', field 'sensing': sensor 3 at (0.9, 0.5, "
                      "0.265) stands in an occupied voxel"),
            std::string::npos);
  EXPECT_NE(refusal({0.9, 0.05, 0.5})
                .find("field 'sensing', team 'box': sensor 3 at (0.9, 0.05, 0.5) is met by 'box'"),
            std::string::npos);
  EXPECT_EQ(refusal({0.9, 0.5, 0.9}), "");
}

}  // namespace sensed_job_test
}  // namespace clearway
