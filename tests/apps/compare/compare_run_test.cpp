// Planners that really crash, hang and eat memory, between ones that do not.
#include "apps/compare/compare_run.hpp"

#include <gtest/gtest.h>
#include <signal.h>
#include <unistd.h>

#include <cstdlib>
#include <fstream>
#include <nlohmann/json.hpp>
#include <stdexcept>

#include "apps/compare/compare_session.hpp"
#include "apps/results/compare_merge.hpp"
#include "planning/planner_table.hpp"
#include "tests/worlds/small_suite.hpp"
#include "tests/worlds/temporary_folder.hpp"

namespace clearway {
namespace compare_run_test {

namespace fs = std::filesystem;

/// What a planner does instead of planning; the question from the start to the start, which is asked before
/// the clock starts, counts as preparation.
enum class Deed { crashes, aborts, throws, hangs, eats, prepares_badly, hangs_preparing };

volatile std::size_t eaten = 0;

void do_it(Deed deed) {
  switch (deed) {
    case Deed::crashes:
    case Deed::prepares_badly:
      ::raise(SIGSEGV);
      return;
    case Deed::aborts:
      std::abort();
    case Deed::throws:
      throw std::logic_error("two and two are five");
    case Deed::hangs:
      for (volatile bool forever = true; forever;) {
      }
      return;
    case Deed::hangs_preparing:  // and takes no processor time
      for (;;) ::pause();
    case Deed::eats:
      try {
        for (;;)
          eaten = eaten + std::string(std::size_t{1} << 26U, 'x').size() +
                  reinterpret_cast<std::size_t>(new std::string(std::size_t{1} << 26U, 'y'));
      } catch (const std::bad_alloc&) {  // and goes on as if nothing had been
      }
  }
}

class BadPlanner : public Planner {
 public:
  explicit BadPlanner(Deed deed) : Planner("bad", {}), deed_(deed) {}
  PlanResult plan(const PlanProblem& problem) const override {
    const bool prepares = problem.start == problem.goal;
    const bool is_bad_then = deed_ == Deed::prepares_badly || deed_ == Deed::hangs_preparing;
    if (prepares == is_bad_then) do_it(deed_);
    return check_ends(problem);
  }

 private:
  Deed deed_;
};

/// The experiment `round` of the small suite; its second planner is bad.
struct BadCompany {
  Suite suite = parse_suite(small_suite, "small.yaml");
  PreparedExperiment prepared = prepare(suite, suite.experiments[0], {});
  TemporaryFolder folder;
  double grace = 600.0;

  explicit BadCompany(Deed deed) {
    prepared.makers[1] = std::make_shared<BadPlanner>(deed);
    prepared.time_limit = 1.0;
  }
  CompareChoice choice(int jobs = 1) const {
    return {.seed = 3,
            .jobs = jobs,
            .out = folder.path(),
            .isolation = {.is_on = true, .grace = grace, .memory = 3e8}};
  }
};

/// All runs of the bad planner ended so, and all others did what they always do.
void expect_only_its_runs(Deed deed, const std::string& ended, const std::string& words, int jobs) {
  SCOPED_TRACE(words);
  const BadCompany company(deed);
  const CompareExperiment found = run_experiment(company.suite, company.prepared, company.choice(jobs));
  ASSERT_EQ(found.problems.size(), 3U);
  for (const CompareProblem& problem : found.problems) {
    ASSERT_EQ(problem.runs.size(), 8U);
    for (const CompareRun& run : problem.runs) {
      if (run.planner == 1) {
        EXPECT_EQ(run.ended, ended);
        EXPECT_EQ(run.outcome(), ended);
        EXPECT_NE(run.explanation.find(words), std::string::npos) << run.explanation;
        EXPECT_FALSE(run.is_solved() || run.is_valid());
        EXPECT_TRUE(run.plan_file.empty());
      } else {
        EXPECT_EQ(run.ended, "");
        EXPECT_EQ(run.is_solved(), problem.name != "blocked");
        EXPECT_TRUE(fs::exists(company.folder.path() / run.plan_file));
      }
    }
  }
}

TEST(IsolatedRuns, ACrashIsTheOutcomeOfThatRunAlone) {
  expect_only_its_runs(Deed::crashes, "crashed", "ended by SIGSEGV", 1);
  expect_only_its_runs(Deed::aborts, "crashed", "ended by SIGABRT", 2);
  expect_only_its_runs(Deed::throws, "crashed", "two and two are five", 1);
}

TEST(IsolatedRuns, ACrashInThePreparationIsOneToo) {
  expect_only_its_runs(Deed::prepares_badly, "crashed", "ended by SIGSEGV", 2);
}

/// Making it, and checking it, would take longer than all else.
TEST(CompareRuns, AMotionOfMoreThanTwentyMinutesIsNotMade) {
  Suite suite = parse_suite(small_suite, "small.yaml");
  suite.experiments[0].problems.resize(1);
  suite.experiments[0].runs = 1;
  for (const double speed : {1.0, 4e-4}) {
    PreparedExperiment prepared = prepare(suite, suite.experiments[0], {"rrtconnect"});
    for (Joint& joint : prepared.robot.joints) joint.max_velocity = speed;
    const TemporaryFolder folder;
    const CompareExperiment found = run_experiment(suite, prepared, {.seed = 3, .out = folder.path()});
    const CompareRun& run = found.problems.at(0).runs.at(0);
    ASSERT_TRUE(run.is_valid()) << run.explanation << run.contact;
    EXPECT_EQ(run.motion.has_value(), speed == 1.0);
  }
}

/// One problem: each hang takes its time.
TEST(IsolatedRuns, AHangEndsWithTheTimeLimitAndWhatIsGranted) {
  for (const Deed deed : {Deed::hangs, Deed::hangs_preparing}) {
    BadCompany company(deed);
    company.suite.experiments[0].problems.resize(1);
    company.suite.experiments[0].runs = 1;
    company.prepared.setup = company.suite.experiments[0];
    company.prepared.time_limit = 0.5;
    company.grace = 4.0;
    const CompareExperiment found = run_experiment(company.suite, company.prepared, company.choice());
    ASSERT_EQ(found.problems.at(0).runs.size(), 4U);
    EXPECT_EQ(found.problems[0].runs[1].ended, "hung");
    EXPECT_NE(found.problems[0].runs[1].explanation.find("4.5 s"), std::string::npos)
        << found.problems[0].runs[1].explanation;
    for (const std::size_t other : {0U, 2U, 3U}) EXPECT_TRUE(found.problems[0].runs[other].is_solved());
  }
}

#if !defined(__SANITIZE_ADDRESS__) && !defined(__SANITIZE_THREAD__)
TEST(IsolatedRuns, TooMuchMemoryIsTheOutcomeEvenWhenThePlannerHidesIt) {
  expect_only_its_runs(Deed::eats, "out_of_memory", "0.3 GB", 1);
}
#endif

TEST(IsolatedRuns, TablesDatabaseAndLogReportThem) {
  const BadCompany company(Deed::crashes);
  CompareResults results;
  results.experiments.push_back(run_experiment(company.suite, company.prepared, company.choice()));
  EXPECT_EQ(summary(results.experiments[0], 1).unsolved,
            (std::map<std::string, std::size_t>{{"crashed", 6}}));
  EXPECT_NE(to_csv(results).find(",crashed,0,0,none,"), std::string::npos);
  EXPECT_NE(to_ompl_log(results).find("; 0; ; 7; "), std::string::npos);
  EXPECT_NE(to_html(results).find("\"crashed\""), std::string::npos);
  const auto sentences = runs_without_answer(results);
  ASSERT_EQ(sentences.size(), 6U);
  EXPECT_TRUE(sentences[0].starts_with("run 'round/there/beam_k_10-1': crashed: ") ||
              sentences[0].starts_with("run 'round/there/beam_k=10-1': crashed: "))
      << sentences[0];
}

TEST(IsolatedRuns, WithoutIsolationAnErrorNamesProblemAndPlanner) {
  const BadCompany company(Deed::throws);
  CompareChoice choice = company.choice();
  choice.isolation.is_on = false;
  try {
    run_experiment(company.suite, company.prepared, choice);
    ADD_FAILURE() << "a planner that throws was not heard";
  } catch (const std::runtime_error& error) {
    EXPECT_TRUE(std::string(error.what()).starts_with("experiment 'round', problem '")) << error.what();
    const std::string label = company.prepared.planners[1].label;
    EXPECT_NE(
        std::string(error.what()).find("planner '" + label + "': the run ended with an error: a library"),
        std::string::npos)
        << error.what();
  }
}

TEST(IsolatedRuns, WithoutIsolationFindTheSame) {
  const Suite suite = parse_suite(small_suite, "small.yaml");
  const PreparedExperiment prepared = prepare(suite, suite.experiments[0], {});
  const TemporaryFolder one, other;
  const auto rows = [&](const TemporaryFolder& folder, bool isolated) {
    CompareExperiment found =
        run_experiment(suite, prepared, {.seed = 3, .out = folder.path(), .isolation = {.is_on = isolated}});
    for (CompareProblem& problem : found.problems)
      for (CompareRun& run : problem.runs) {
        run.work = {};
        run.time = run.cpu = run.space_cpu = run.derive_cpu = run.check_time = run.check_cpu =
            run.motion_cpu = 0.0;
      }
    return csv_rows("s", "e", found.planners, found.problems.at(1));
  };
  EXPECT_EQ(rows(one, true), rows(other, false));
}

}  // namespace compare_run_test
}  // namespace clearway
