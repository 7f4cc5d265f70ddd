#include "apps/results/compare_diff.hpp"

#include <gtest/gtest.h>
#include <sqlite3.h>

#include <functional>

#include "tests/worlds/temporary_folder.hpp"

namespace clearway {
namespace compare_diff_test {

using Change = std::function<void(std::size_t problem, CompareRun&)>;

/// 40 problems of one planner that solves all but the last four, changed.
CompareResults results_with(const Change& change) {
  CompareResults results;
  results.host = "here";
  CompareExperiment& experiment = results.experiments.emplace_back();
  experiment.setup.name = "e";
  experiment.planners = {{"one", "beam", {}, true}};
  for (std::size_t i = 0; i < 40; ++i) {
    CompareProblem& problem = experiment.problems.emplace_back();
    problem.name = "p" + std::to_string(i);
    CompareRun run;
    run.status = i < 36 ? PlanStatus::solved : PlanStatus::no_path;
    run.check = i < 36 ? "valid" : "none";
    run.cpu = 0.1 + 0.01 * static_cast<double>(i);
    run.cost = 10.0 + static_cast<double>(i);
    run.length = 2.0;
    change(i, run);
    problem.runs.push_back(run);
  }
  return results;
}

CompareDiff diff_with(const Change& change) {
  const TemporaryFolder folder;
  save_database(results_with([](std::size_t, CompareRun&) {}), folder.path() / "old.sqlite");
  save_database(results_with(change), folder.path() / "new.sqlite");
  return compare_diff(folder.path() / "old.sqlite", folder.path() / "new.sqlite");
}

void fail(CompareRun& run, PlanStatus status) {
  run.status = status;
  run.check = "none";
}

/// What a database makes of the table of runs by itself.
TEST(CompareDiff, ADatabaseThatIsAProgramIsRefused) {
  const TemporaryFolder folder;
  const auto file = folder.path() / "hostile.sqlite";
  save_database(results_with([](std::size_t, CompareRun&) {}), file);
  sqlite3* database = nullptr;
  ASSERT_EQ(sqlite3_open(file.c_str(), &database), SQLITE_OK);
  ASSERT_EQ(sqlite3_exec(database,
                         "ALTER TABLE runs RENAME TO stored; CREATE VIEW runs AS WITH RECURSIVE n(i) AS "
                         "(SELECT 1 UNION ALL SELECT i + 1 FROM n) SELECT stored.* FROM stored, n;",
                         nullptr, nullptr, nullptr),
            SQLITE_OK);
  sqlite3_close(database);
  EXPECT_THROW(compare_diff(file, file), std::invalid_argument);  // and ends
}

TEST(CompareDiff, NoiseIsNoChange) {
  const CompareDiff diff =
      diff_with([](std::size_t i, CompareRun& run) { run.cpu *= i % 2 == 0 ? 1.2 : 1.0 / 1.2; });
  ASSERT_EQ(diff.rows.size(), 1U);
  EXPECT_EQ(diff.rows[0].runs, 40U);
  EXPECT_EQ(diff.rows[0].other_paths, 0U);
  EXPECT_FALSE(diff.is_worse());
  EXPECT_TRUE(diff.rows[0].better.empty());
  EXPECT_TRUE(diff.notes.empty());
}

TEST(CompareDiff, RunsThatOneAloneHasAreCountedAsLeftOut) {
  const TemporaryFolder folder;
  const auto old_file = folder.path() / "old.sqlite", new_file = folder.path() / "new.sqlite";
  CompareResults results = results_with([](std::size_t, CompareRun&) {});
  save_database(results, old_file);
  results.experiments[0].problems.resize(17);
  save_database(results, new_file);
  const CompareDiff diff = compare_diff(old_file, new_file), back = compare_diff(new_file, old_file);
  ASSERT_EQ(diff.notes.size(), 1U);
  EXPECT_EQ(diff.notes[0], "Of 'one' in experiment 'e' 23 of 40 runs are in '" + old_file.string() +
                               "' alone: nothing is said of them.");
  EXPECT_EQ(back.notes, diff.notes);
}

TEST(CompareDiff, SlowerEverywhereIsWorseUnlessItIsLittle) {
  const auto slower = [](double factor) {
    return diff_with([factor](std::size_t, CompareRun& run) { run.cpu *= factor; });
  };
  const CompareDiff diff = slower(1.3);
  ASSERT_EQ(diff.rows[0].worse.size(), 1U);
  EXPECT_TRUE(diff.rows[0].worse[0].starts_with("CPU time +30 % (p < 0.0001)")) << diff.rows[0].worse[0];
  EXPECT_FALSE(slower(1.03).is_worse());
  EXPECT_EQ(slower(0.5).rows[0].better.size(), 1U);
}

/// No test of ranks can find three problems significant: twice the time, more on each, is worse all the same,
/// and of less the verdict says that it cannot tell.
TEST(CompareDiff, OfFewProblemsItSaysWhatItCannotTell) {
  const auto of_three = [](double factor) {
    const TemporaryFolder folder;
    for (const char* name : {"old.sqlite", "new.sqlite"}) {
      CompareResults results = results_with([&](std::size_t, CompareRun& run) {
        if (name[0] == 'n') run.cpu *= factor;
      });
      results.experiments[0].problems.resize(3);
      save_database(results, folder.path() / name);
    }
    return compare_diff(folder.path() / "old.sqlite", folder.path() / "new.sqlite");
  };
  const CompareDiff hundredfold = of_three(100.0);
  EXPECT_EQ(hundredfold.verdict(), "Worse beyond noise.");
  EXPECT_EQ(hundredfold.rows[0].worse,
            (std::vector<std::string>{"CPU time x 100 (more on each of 3 problems)"}));
  EXPECT_EQ(of_three(0.4).rows[0].better.size(), 1U);
  const std::string same = of_three(1.3).verdict();
  EXPECT_EQ(same.find("Nothing is shown to be worse; 1 of 1 row could show only"), 0U) << same;
  EXPECT_NE(same.find("expected 6 problems or more"), std::string::npos) << same;
  EXPECT_EQ(diff_with([](std::size_t, CompareRun&) {}).verdict(), "Nothing is worse beyond noise.");
}

/// Costs that differ in the last bit, all one way, and by less than anybody would mind.
TEST(CompareDiff, CostsThatAreTheSameToAThousandthAreNeitherWorseNorBetter) {
  for (const double factor : {1.0 + 4e-16, 1.0 + 1e-12, 1.0005, 1.0 - 1e-12}) {
    const CompareDiff diff = diff_with([&](std::size_t, CompareRun& run) { run.cost *= factor; });
    EXPECT_TRUE(diff.rows[0].worse.empty() && diff.rows[0].better.empty()) << factor;
  }
  EXPECT_TRUE(diff_with([](std::size_t, CompareRun& run) { run.cost *= 1.01; }).is_worse());
  const CompareDiff some = diff_with([](std::size_t i, CompareRun& run) { run.cost *= i < 12 ? 2.0 : 1.0; });
  const CompareDiff few = diff_with(  // most of those that change gain a little, and some lose much
      [](std::size_t i, CompareRun& run) { run.cost *= i < 16   ? 0.98
                                                       : i < 18 ? 2.7
                                                                : 1.0; });
  EXPECT_TRUE(few.rows[0].worse.empty());
  ASSERT_EQ(some.rows[0].worse.size(), 1U);  // 12 of the 36 that are solved
  EXPECT_TRUE(some.rows[0].worse[0].starts_with("path cost x 2 where it changed (p = 0.00"))
      << some.rows[0].worse[0];
}

TEST(CompareDiff, NamesWhatWasAskedOtherwise) {
  const TemporaryFolder folder;
  const auto old_file = folder.path() / "old.sqlite", new_file = folder.path() / "new.sqlite";
  CompareResults results = results_with([](std::size_t, CompareRun&) {});
  CompareExperiment& experiment = results.experiments[0];
  experiment.time_limit = 1.0;
  save_database(results, old_file);
  experiment.time_limit = 0.5;
  experiment.setup.padding = 0.01;
  experiment.problems[7].goals = {Configuration::Constant(2, 0.25)};
  save_database(results, new_file);
  EXPECT_EQ(compare_diff(old_file, new_file).notes,
            (std::vector<std::string>{
                "The starts or goals of 1 problem differ, as in 'p7' in experiment 'e': what changed may be "
                "theirs.",
                "Experiment 'e' was asked with another padding (0.0, then 0.01), time limit (1.0, then 0.5): "
                "what changed may be theirs."}));
  EXPECT_TRUE(compare_diff(new_file, new_file).notes.empty());
}

TEST(CompareDiff, NamesOptionsOfPlannersAndSeedsThatDiffer) {
  const TemporaryFolder folder;
  const auto old_file = folder.path() / "old.sqlite", new_file = folder.path() / "new.sqlite";
  CompareResults results = results_with([](std::size_t, CompareRun&) {});
  CompareExperiment& experiment = results.experiments[0];
  experiment.planners[0].options = {{"width", "10"}, {"depth", "3"}};
  save_database(results, old_file);
  experiment.planners[0].options = {{"width", "20"}, {"depth", "3"}, {"turns", "yes"}};
  save_database(results, new_file);
  EXPECT_EQ(compare_diff(old_file, new_file).notes,
            (std::vector<std::string>{
                "'one' in experiment 'e' was asked with another turns (none, then yes), width "
                "(10, then 20): what changed may be theirs."}));
  results.seed = 9;
  for (CompareProblem& problem : experiment.problems) problem.runs[0].seed = 9;
  save_database(results, new_file);
  try {
    compare_diff(old_file, new_file);
    ADD_FAILURE() << "runs of other seeds were compared";
  } catch (const std::invalid_argument& error) {
    EXPECT_TRUE(std::string(error.what()).ends_with("the same suite and seed, got seeds 1 and 9"))
        << error.what();
  }
}

TEST(CompareDiff, ManyRunsThatAClockTookAreWorse) {
  const auto lost = [](std::size_t count) {
    return diff_with([count](std::size_t i, CompareRun& run) {
             if (i < count) fail(run, PlanStatus::timed_out);
           })
        .rows[0]
        .worse.size();
  };
  EXPECT_EQ(lost(2), 0U);
  EXPECT_EQ(lost(20), 1U);
}

TEST(CompareDiff, RunsLostToNoClockAreWorseAloneAndAShuffleIsNot) {
  const CompareDiff one = diff_with([](std::size_t i, CompareRun& run) {
    if (i == 3) fail(run, PlanStatus::no_path);
  });
  EXPECT_EQ(one.rows[0].lost, 1U);
  EXPECT_TRUE(one.is_worse());
  EXPECT_FALSE(diff_with([](std::size_t i, CompareRun& run) {
                 if (i == 3) fail(run, PlanStatus::timed_out);
               }).is_worse());
  const CompareDiff shuffled = diff_with([](std::size_t i, CompareRun& run) {
    if (i < 4) fail(run, PlanStatus::no_path);
    if (i >= 36) {
      run.status = PlanStatus::solved;
      run.check = "valid";
    }
  });
  EXPECT_EQ(shuffled.rows[0].lost, 4U);
  EXPECT_EQ(shuffled.rows[0].won, 4U);
  EXPECT_FALSE(shuffled.is_worse());
}

/// It need not do the same with the same seed.
TEST(CompareDiff, OfAnExternalProgramTheTestAloneDecides) {
  const auto is_worse = [](std::size_t lost) {
    const TemporaryFolder folder;
    CompareResults before = results_with([](std::size_t, CompareRun&) {}),
                   after = results_with([&](std::size_t i, CompareRun&run) {
                     if (i < lost) fail(run, PlanStatus::no_path);
                   });
    for (CompareResults* results : {&before, &after})
      results->experiments[0].planners = {{"one", "external", {}, true}};
    save_database(before, folder.path() / "old.sqlite");
    save_database(after, folder.path() / "new.sqlite");
    const CompareDiff diff = compare_diff(folder.path() / "old.sqlite", folder.path() / "new.sqlite");
    const std::string words =
        " Runs of external planners count only by the sign test: 'one' in experiment "
        "'e' lost " +
        std::to_string(lost) + ", won 0.";
    EXPECT_EQ(diff.verdict().ends_with(words), lost > 0 && !diff.is_worse()) << diff.verdict();
    return diff.is_worse();
  };
  EXPECT_FALSE(is_worse(0));
  EXPECT_FALSE(is_worse(1));
  EXPECT_FALSE(is_worse(4));
  EXPECT_TRUE(is_worse(12));
}

TEST(CompareDiff, CountsOtherPathsAndNamesWhatCannotBeCompared) {
  const TemporaryFolder folder;
  CompareResults before = results_with([](std::size_t, CompareRun&) {}), after = before;
  after.experiments[0].problems[0].runs[0].length = 3.0;
  after.host = "there";
  after.experiments[0].planners.push_back({"two", "est", {}, true});
  CompareRun other = after.experiments[0].problems[0].runs[0];
  other.planner = 1;
  after.experiments[0].problems[0].runs.push_back(other);
  save_database(before, folder.path() / "old.sqlite");
  save_database(after, folder.path() / "new.sqlite");
  const CompareDiff diff = compare_diff(folder.path() / "old.sqlite", folder.path() / "new.sqlite");
  EXPECT_EQ(diff.rows[0].other_paths, 1U);
  ASSERT_EQ(diff.notes.size(), 2U);
  EXPECT_NE(diff.notes[0].find("machines differ"), std::string::npos);
  EXPECT_NE(diff.notes[1].find("'two' in experiment 'e'"), std::string::npos);
  after.experiments[0].problems[3].map_sha256 = "01";
  after.experiments[0].robot_sha256 = "02";
  after.experiments[0].problems_sha256 = "03";
  save_database(after, folder.path() / "new.sqlite");
  const CompareDiff others = compare_diff(folder.path() / "old.sqlite", folder.path() / "new.sqlite");
  ASSERT_EQ(others.notes.size(), 5U);
  EXPECT_NE(others.notes[1].find("robots of experiment 'e' differ"), std::string::npos) << others.notes[1];
  EXPECT_NE(others.notes[2].find("maps of 1 problem differ, as in 'p3'"), std::string::npos)
      << others.notes[2];
  EXPECT_NE(others.notes[3].find("problems of experiment 'e' differ, in their loads"), std::string::npos)
      << others.notes[3];
  for (CompareProblem& problem : after.experiments[0].problems) problem.name += "x";
  save_database(after, folder.path() / "new.sqlite");
  EXPECT_THROW(compare_diff(folder.path() / "old.sqlite", folder.path() / "new.sqlite"),
               std::invalid_argument);
  folder.write("new.sqlite", "nonsense");
  EXPECT_THROW(compare_diff(folder.path() / "old.sqlite", folder.path() / "new.sqlite"),
               std::invalid_argument);
}

}  // namespace compare_diff_test
}  // namespace clearway
