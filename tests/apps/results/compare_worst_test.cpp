#include "apps/results/compare_worst.hpp"

#include <gtest/gtest.h>

#include <fstream>
#include <random>
#include <set>

#include "tests/worlds/temporary_folder.hpp"

namespace clearway {
namespace compare_worst_test {

namespace fs = std::filesystem;

CompareExperiment drawn(int runs) {
  std::mt19937 dice(11);
  CompareExperiment experiment;
  experiment.setup.name = "e";
  experiment.setup.runs = runs;
  experiment.planners = {{"a", "beam", {}, true}, {"b", "rrtconnect", {}, true}};
  for (int i = 0; i < 20; ++i) {
    CompareProblem problem;
    problem.name = "p " + std::to_string(i);
    for (std::size_t p = 0; p < 2; ++p) {
      for (int number = 1; number <= runs; ++number) {
        CompareRun run;
        run.planner = p;
        run.number = number;
        run.status = dice() % 4 == 0 ? PlanStatus::timed_out : PlanStatus::solved;
        run.check = run.is_solved() ? (dice() % 5 == 0 ? "refused" : "valid") : "none";
        run.time = static_cast<double>(dice() % 100000);
        run.cost = 1.0 + static_cast<double>(dice() % 1000);
        run.min_clearance = 1e-6 * static_cast<double>(dice() % 100000);
        if (dice() % 3 != 0) run.plan_file = "plan.json";
        problem.runs.push_back(run);
      }
    }
    experiment.problems.push_back(problem);
  }
  return experiment;
}

const CompareRun& run_of(const CompareExperiment& experiment, const WorstCase& worst) {
  return experiment.problems.at(worst.problem).runs.at(worst.run);
}

/// Whether no run of its planner is worse, by looking at each.
bool is_worst(const CompareExperiment& experiment, const WorstCase& worst) {
  const CompareRun& own = run_of(experiment, worst);
  for (const CompareProblem& problem : experiment.problems) {
    double best = 1e300, own_best = 1e300;
    for (const CompareRun& run : problem.runs)
      if (run.is_valid()) best = std::min(best, run.cost);
    for (const CompareRun& run : experiment.problems[worst.problem].runs)
      if (run.is_valid()) own_best = std::min(own_best, run.cost);
    for (const CompareRun& run : problem.runs) {
      if (run.planner != own.planner || run.is_valid() != own.is_valid()) continue;
      if (worst.kind == WorstCase::tightest && run.min_clearance < own.min_clearance) return false;
      if (worst.kind == WorstCase::dearest && run.cost / best > own.cost / own_best) return false;
      const bool is_timed = worst.kind == WorstCase::failed || worst.kind == WorstCase::slowest;
      if (is_timed && run.time > own.time) return false;
    }
  }
  return own.is_valid() != (worst.kind == WorstCase::failed);
}

TEST(WorstCases, AreThoseThatNoOtherRunOfThePlannerExceeds) {
  const CompareExperiment experiment = drawn(3);
  const auto all = worst_cases(experiment);
  ASSERT_EQ(all.size(), 8U);
  for (const WorstCase& worst : all) EXPECT_TRUE(is_worst(experiment, worst)) << to_string(worst.kind);
}

TEST(WorstCases, OfTeamsAndOfNothingAreNone) {
  CompareExperiment experiment = drawn(1);
  for (CompareProblem& problem : experiment.problems)
    for (CompareRun& run : problem.runs) run.check = "refused";
  for (const WorstCase& worst : worst_cases(experiment)) EXPECT_EQ(worst.kind, WorstCase::failed);
  EXPECT_EQ(worst_cases(experiment).size(), 2U);
  experiment.setup.teams.emplace();
  EXPECT_TRUE(worst_cases(experiment).empty());
}

TEST(WorstPages, AreAtMostSoManyAndTheWorstOfAllComeFirst) {
  const CompareExperiment experiment = drawn(3);
  EXPECT_TRUE(worst_pages(experiment, 0).empty());
  const auto three = worst_pages(experiment, 3), all = worst_pages(experiment, 1000);
  ASSERT_EQ(three.size(), 3U);
  EXPECT_LE(all.size(), 8U);
  std::set<std::pair<std::size_t, int>> once;
  for (const WorstPage& page : all) EXPECT_TRUE(once.insert({page.problem, page.number}).second);
  double longest = 0.0;
  std::pair<std::size_t, int> failed;
  for (std::size_t i = 0; i < experiment.problems.size(); ++i)
    for (const CompareRun& run : experiment.problems[i].runs)
      if (!run.is_valid() && run.time > longest) {
        longest = run.time;
        failed = {i, run.number};
      }
  EXPECT_EQ(three[0].problem, failed.first);
  EXPECT_EQ(three[0].number, failed.second);
}

TEST(WorstPages, AreNotDrawnWhereTheProblemHasAPageOfThatRun) {
  CompareExperiment experiment = drawn(1);
  for (CompareProblem& problem : experiment.problems) problem.page = "animations/e/p.html";
  EXPECT_TRUE(worst_pages(experiment, 1000).empty());
}

TEST(WorstPages, AreLinkedWhereTheyAreAndOpenAtThePlanOfTheRun) {
  CompareExperiment experiment = drawn(2);
  const TemporaryFolder folder;
  const auto pages = worst_pages(experiment, 2);
  for (const WorstPage& page : pages) {
    const fs::path name = worst_page_file(experiment, experiment.problems[page.problem], page.number);
    EXPECT_EQ(name.string(),
              "worst/e/p_" + std::to_string(page.problem) + "-" + std::to_string(page.number) + ".html");
    fs::create_directories((folder.path() / name).parent_path());
    std::ofstream(folder.path() / name) << "a page";
  }
  link_worst_pages(folder.path(), experiment);
  std::size_t linked = 0;
  for (std::size_t i = 0; i < experiment.problems.size(); ++i) {
    const auto& runs = experiment.problems[i].runs;  // planner by planner, two each
    for (std::size_t r = 0; r < runs.size(); ++r) {
      if (runs[r].page.empty()) continue;
      ++linked;
      const std::string file = runs[r].page.substr(0, runs[r].page.find('#'));
      EXPECT_TRUE(fs::exists(folder.path() / file)) << file;
      const bool is_second = r >= 2 && !runs[r - 2].plan_file.empty();
      EXPECT_EQ(runs[r].page.substr(file.size()),
                runs[r].plan_file.empty() ? "" : "#plan=" + std::to_string(static_cast<int>(is_second)));
    }
  }
  EXPECT_GE(linked, 2U);
}

}  // namespace compare_worst_test
}  // namespace clearway
