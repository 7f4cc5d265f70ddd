#include "apps/results/compare_resolutions.hpp"

#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

#include "tests/apps/page_reader.hpp"
#include "tests/apps/run_command.hpp"

namespace clearway {
namespace compare_resolutions_test {

CompareRun run(double time, bool is_valid) {
  CompareRun made;
  made.status = PlanStatus::solved;
  made.check = is_valid ? "valid" : "refused";
  made.time = time;
  return made;
}

/// `valid` of ten problems are valid; problem i starts at `offset` + i.
CompareExperiment experiment_at(const std::string& name, double resolution, int valid, double offset) {
  CompareExperiment experiment;
  experiment.setup.name = name;
  experiment.setup.alike = "all";
  experiment.planners = {{"p", "beam", {}, true}};
  for (int i = 0; i < 10; ++i) {
    CompareProblem problem;
    problem.resolution = resolution;
    problem.start = Configuration::Constant(1, offset + i);
    problem.goals = {Configuration::Constant(1, -1.0)};
    problem.runs = {run(resolution * (i + 1), i < valid)};
    experiment.problems.push_back(problem);
  }
  return experiment;
}

TEST(CompareResolutions, StandSideBySideFinestFirst) {
  CompareResults results;
  results.experiments = {experiment_at("coarse", 0.4, 9, 0), experiment_at("fine", 0.1, 3, 0),
                         experiment_at("other", 0.2, 5, 0)};
  results.experiments[2].setup.alike.clear();
  const auto sweeps = resolution_sweeps(results);
  ASSERT_EQ(sweeps.size(), 1U);
  EXPECT_EQ(sweep_name(results, sweeps[0]), "fine, coarse");
  EXPECT_EQ(sweeps[0].resolutions, (std::vector<double>{0.1, 0.4}));
  EXPECT_EQ(sweeps[0].planners.at(0).points.at(0).valid, 3U);
  EXPECT_EQ(sweeps[0].planners.at(0).points.at(1).valid, 9U);
  EXPECT_DOUBLE_EQ(sweeps[0].planners.at(0).points.at(0).time_median, 0.55)
      << "between the fifth and the sixth";
  const auto table = sweep_table(results, sweeps[0]);
  ASSERT_EQ(table.size(), 3U);
  EXPECT_EQ(table[1][1], "100");
  EXPECT_EQ(table[2][2], "10 / 9 / 10");
}

TEST(CompareResolutions, SayHowManyProblemsAreTheSame) {
  CompareResults results;
  results.experiments = {experiment_at("a", 0.4, 9, 0), experiment_at("b", 0.1, 3, 0)};
  EXPECT_EQ(sweep_note(resolution_sweeps(results).at(0)), "The same problems at all resolutions.");
  results.experiments[1] = experiment_at("b", 0.1, 3, 4);  // 4 … 13: six are in 0 … 9
  EXPECT_EQ(resolution_sweeps(results).at(0).same_problems, 6U);
  results.experiments[1].problems.clear();  // interrupted before it began
  EXPECT_TRUE(resolution_sweeps(results).empty());
}

const std::string suite = R"(
planners: [{planner: rrtconnect}]
worlds: [{name: free, resolution: 0.05, volumes: [{label: all, strokes: [{balls: [[0, 0, 0, 0.6]]}]}]}]
experiments:
  - {name: near, robot: point, world: free, resolutions: [0.1, 0.04], policies: {default: painted},
     problems: [{name: on, start: [0, 0], goals: [[0.2, 0]]}]}
)";

TEST(CompareResolutions, AListInASuiteComesToTablePageAndJson) {
  TemporaryFolder folder;
  const std::string file = folder.write("near.yaml", suite);
  const CommandRun run = run_command({"compare", "--worst-pages", "0", file, "--out", folder.file("out")});
  ASSERT_EQ(run.status, 0) << run.log;
  EXPECT_NE(run.out.find("== effect of resolution: near-0.04, near-0.1\n"), std::string::npos) << run.out;
  EXPECT_NE(run.out.find("rrtconnect  40         1 / 1 / 1"), std::string::npos) << run.out;
  const auto page = nlohmann::json::parse(PageReader::element(
      read_file(folder.file("out/report.html")), "<script type=\"application/json\" id=\"page\">"));
  EXPECT_EQ(page.at("resolutions").at(0).at("resolutions_m"), nlohmann::json({0.04, 0.1}));
  const CommandRun one = run_command({"compare", "--worst-pages", "0", file, "--out", folder.file("one"),
                                      "--experiments", "near", "--planners", "rrtconnect", "--json"});
  ASSERT_EQ(one.status, 0) << one.log;
  EXPECT_EQ(nlohmann::json::parse(one.out).at("resolutions").at(0).at("planners").at(0).at("points").size(),
            2U);
  const CommandRun fine = run_command(
      {"compare", "--worst-pages", "0", file, "--out", folder.file("fine"), "--experiments", "near-0.04"});
  ASSERT_EQ(fine.status, 0) << fine.log;
  EXPECT_EQ(fine.out.find("effect of resolution"), std::string::npos) << "one resolution has no effect";
  EXPECT_EQ(run_command({"compare", "--worst-pages", "0", file, "--rerun", "near-0.1/on/rrtconnect"}).status,
            0);
}

}  // namespace compare_resolutions_test
}  // namespace clearway
