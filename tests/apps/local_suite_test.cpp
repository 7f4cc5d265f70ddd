#include <gtest/gtest.h>
#include <sqlite3.h>

#include "apps/suites/suite_reaching.hpp"
#include "planning/check/path_check.hpp"
#include "planning/planner_table.hpp"
#include "planning/problem/planner.hpp"
#include "planning/robot_files/load_robot.hpp"
#include "tests/apps/run_command.hpp"

namespace clearway {
namespace local_suite_test {

const Policies open{.parts = {}, .critical_by_default = false};

TEST(LocalSuite, InASampleBoundaryPlusSolvesWhatRrtConnectSolvesAndTheLocalMethodHalfOfItAtMost) {
  int reference = 0, local = 0;
  const std::pair<const char*, const char*> draws[] = {
      {"shelf", "puma560"}, {"table", "arm5"}, {"ladder", "panda"}, {"cage", "puma560"}};
  for (const auto& [kind, name] : draws) {
    const Robot robot = load_robot(name);
    const SuiteGenerator generator{.kind = kind, .count = 3, .seed = 1, .resolution = 0.05};
    const ReachingScene scene = draw_reaching(generator, 0, robot, open, 0.0);
    const ConfigurationSpace space(robot, scene.map, open);
    const PathCost cost(robot);
    for (const StageProblem& drawn : scene.problems) {
      const PlanProblem problem{space, cost, drawn.start, drawn.goals[0]};
      const auto plan = [&](const char* planner, const PlannerOptions& options) {
        return make_planner(planner, options)->plan(problem);
      };
      if (plan("rrtconnect", {{"max_samples", "2000"}}).status != PlanStatus::solved) continue;
      ++reference;
      local += plan("constraint", {}).status == PlanStatus::solved;
      const PlanResult result = plan("boundary_plus", {});
      ASSERT_EQ(result.status, PlanStatus::solved) << drawn.name << " " << name << result.explanation;
      const PathVerdict verdict = check_path(robot, scene.map, space.policies(), 0.0, result.waypoints);
      EXPECT_TRUE(verdict.valid) << drawn.name << " " << name << verdict.first_contact;
    }
  }
  EXPECT_GE(reference, 8);
  EXPECT_LE(2 * local, reference);
}

using Rows = std::vector<std::vector<std::string>>;

int add_row(void* rows, int columns, char** values, char**) {
  auto& row = static_cast<Rows*>(rows)->emplace_back();
  for (int c = 0; c < columns; ++c) row.emplace_back(values[c] != nullptr ? values[c] : "");
  return 0;
}

TEST(LocalSuite, ItsQueryCountsOnWhatRrtConnectSolves) {
  TemporaryFolder folder;
  const std::string suite = folder.write("s.yaml", R"(
time_limit: 20
experiments:
  - name: table_arm5
    robot: arm5
    generate: {kind: table, count: 3, seed: 1, resolution: 0.06}
    policies: {default: not_occupied}
    planners: [{planner: rrtconnect}, {planner: boundary_plus}]
)");
  ASSERT_EQ(run_command({"compare", suite, "--out", folder.file("out"), "--worst-pages", "0"}).status, 0);
  sqlite3* database = nullptr;
  ASSERT_EQ(sqlite3_open(folder.file("out/results.sqlite").c_str(), &database), SQLITE_OK);
  const std::string sql = read_file(CLEARWAY_SOURCE_DIR "/datasets/suites/local.sql");
  Rows rows;
  EXPECT_EQ(sqlite3_exec(database, sql.c_str(), add_row, &rows, nullptr), SQLITE_OK)
      << sqlite3_errmsg(database);
  sqlite3_close(database);
  ASSERT_GE(rows.size(), 5u);  // two planners, twice, and the stages
  EXPECT_EQ(rows[0][0], "rrtconnect");
  EXPECT_EQ(rows[1][0], "boundary_plus");
  for (const std::size_t planner : {0, 1}) {
    EXPECT_EQ(rows[planner][1], "3");      // of rrtconnect's
    EXPECT_EQ(rows[planner][3], "3");      // valid
    EXPECT_EQ(rows[planner][4], "100.0");  // percent
    EXPECT_GT(std::stod(rows[planner][6]), 0.0);
  }
  EXPECT_EQ(rows[2][1], "arm5");
  EXPECT_EQ(rows[3][3], "3 / 3");
  int stages = 0;
  for (std::size_t r = 4; r < rows.size(); ++r) stages += std::stoi(rows[r][1]);
  EXPECT_EQ(stages, 3);
}

}  // namespace local_suite_test
}  // namespace clearway
