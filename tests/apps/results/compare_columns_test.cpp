// What the database holds of local planners and of teams, read back with SQLite, against the JSON of each
// run.

#include <gtest/gtest.h>
#include <sqlite3.h>

#include <algorithm>
#include <fstream>
#include <map>
#include <nlohmann/json.hpp>
#include <numeric>
#include <set>

#include "apps/results/compare_columns.hpp"
#include "tests/apps/page_reader.hpp"
#include "tests/apps/run_command.hpp"

namespace clearway {
namespace compare_columns_test {

using nlohmann::json;
/// By name of column; NULL is null.
using Record = std::map<std::string, json>;

/// A disc before a wall, alone and with another one among a ball, one that an obstacle runs over, and two
/// that overlap.
const std::string suite = R"(
worlds:
  - name: wall
    resolution: 0.05
    solids:
      - {name: wall, box: [0.1, 1.5, 0.1], pose: [1.05, 0.15, 0, 0, 0, 0]}
    sensors: [[-1, 0, 0.02], [3, 0, 0.02]]
experiments:
  - name: alone
    robot: point
    world: wall
    problems:
      - {name: one leg, start: [0, 0], goals: [[2.5, 0.05]]}
      - {name: two legs, start: [0, 0], goals: [[2.5, 0.05], [0, 0]]}
    policies: {default: not_occupied}
    planners: [{planner: constraint}, {planner: boundary}, {planner: boundary_plus, label: no trees, options: {max_samples: 0}},
               {planner: boundary_plus, label: no planes, options: {planes: 0, local_steps: 0}}, {planner: rrtconnect}]
    time_limit: 60
  - name: together
    planners: [{planner: boundary}]
    duration: 20
    teams:
      - name: past each other
        robots:
          - {name: left, robot: point, start: [0, 0], goal: [2, 0]}
          - {name: right, robot: point, start: [2, 0.1], goal: [0, 0.1]}
        moving:
          - shape: {name: ball, sphere: 0.1}
            path: [{time: 0, pose: [1, 2, 0, 0, 0, 0]}, {time: 10, pose: [1, -2, 0, 0, 0, 0]}]
      - name: run over
        robots: [{name: slow, robot: point, start: [0, 0], goal: [0, 0.5]}]
        moving:
          - shape: {name: train, box: [0.4, 4, 0.4]}
            path: [{time: 0, pose: [3, 0, 0, 0, 0, 0]}, {time: 1, pose: [-3, 0, 0, 0, 0, 0]}]
      - name: on each other
        robots:
          - {name: left, robot: point, start: [0, 0], goal: [2, 0]}
          - {name: right, robot: point, start: [0.1, 0], goal: [0, 1]}
)";

class CompareColumns : public testing::Test {
 protected:
  static void SetUpTestSuite() {
    folder_ = std::make_unique<TemporaryFolder>();
    const CommandRun run = run_command({"compare", "--worst-pages", "0", folder_->write("who.yaml", suite),
                                        "--out", folder_->file("out"), "--json"});
    ASSERT_EQ(run.status, 0) << run.log;
    printed_ = json::parse(run.out);
  }
  static void TearDownTestSuite() { folder_.reset(); }

  static json file(const std::string& name) {
    std::ifstream in(folder_->path() / "out" / name);
    return json::parse(in);
  }

  static json cell(sqlite3_stmt* row, int column) {
    switch (sqlite3_column_type(row, column)) {
      case SQLITE_INTEGER:
        return sqlite3_column_int64(row, column);
      case SQLITE_FLOAT:
        return sqlite3_column_double(row, column);
      case SQLITE_NULL:
        return nullptr;
      default:
        return reinterpret_cast<const char*>(sqlite3_column_text(row, column));
    }
  }

  static std::vector<Record> runs(const std::string& where) {
    sqlite3* database = nullptr;
    const std::string path = folder_->file("out/results.sqlite");
    EXPECT_EQ(sqlite3_open_v2(path.c_str(), &database, SQLITE_OPEN_READONLY, nullptr), SQLITE_OK);
    const std::string sql =
        "SELECT problems.name AS problem_name, experiments.name AS experiment, runs.* FROM runs JOIN "
        "problems "
        "ON problem = problems.id JOIN experiments ON experiment = experiments.id WHERE " +
        where + " ORDER BY runs.id";
    sqlite3_stmt* statement = nullptr;
    EXPECT_EQ(sqlite3_prepare_v2(database, sql.c_str(), -1, &statement, nullptr), SQLITE_OK)
        << sqlite3_errmsg(database);
    std::vector<Record> found;
    while (sqlite3_step(statement) == SQLITE_ROW) {
      Record& record = found.emplace_back();
      for (int c = 0; c < sqlite3_column_count(statement); ++c)
        record[sqlite3_column_name(statement, c)] = cell(statement, c);
    }
    sqlite3_finalize(statement);
    sqlite3_close(database);
    return found;
  }

  static std::unique_ptr<TemporaryFolder> folder_;
  static json printed_;
};
std::unique_ptr<TemporaryFolder> CompareColumns::folder_;
json CompareColumns::printed_;

TEST_F(CompareColumns, HaveNamesOfTheirOwn) {
  std::set<std::string> names;
  for (const RunColumn& column : run_columns()) EXPECT_TRUE(names.insert(column.name).second) << column.name;
}

TEST_F(CompareColumns, HoldOfLocalPlannersWhatTheirPlansHold) {
  const auto found = runs("experiments.name = 'alone' AND planner != 'rrtconnect'");
  ASSERT_EQ(found.size(), 8U);
  for (const Record& run : found) {
    SCOPED_TRACE(run.at("problem_name").dump() + run.at("label").dump());
    const json plan = file(run.at("plan").get<std::string>());
    const auto each_leg = [&](const char* name) {
      std::vector<double> values;
      for (const json& leg : plan.at("legs"))
        if (leg.at("statistics").contains(name)) values.push_back(leg.at("statistics").at(name));
      return values;
    };
    for (const char* name : {"deadlocks", "steps_local", "steps_boundary", "constraint_switches",
                             "planes_tried", "hand_over_rounds", "samples", "steps_relaxed"}) {
      const auto values = each_leg(name);
      EXPECT_EQ(run.at(name).is_null(), values.empty()) << name;
      if (!values.empty()) {
        EXPECT_EQ(run.at(name), std::accumulate(values.begin(), values.end(), 0.0)) << name;
      }
    }
    for (const char* name : {"security_distance_m", "influence_distance_m", "xi_m", "max_step"}) {
      ASSERT_FALSE(each_leg(name).empty()) << name;
      EXPECT_EQ(run.at(name), each_leg(name)[0]) << name;
    }
    const auto least = each_leg("least_separation_m");
    EXPECT_EQ(run.at("least_separation_m").is_null(), least.empty());
    if (!least.empty()) {
      EXPECT_EQ(run.at("least_separation_m"), *std::min_element(least.begin(), least.end()));
    }
    for (const char* name : {"step_bound_m", "obstacle_speed_m_s", "safe", "outrun"})
      EXPECT_TRUE(run.at(name).is_null()) << name;
    EXPECT_EQ(run.at("solved_by").is_null(), run.at("planner") != "boundary_plus");
    for (const char* name : {"cpu_s", "space_cpu_s", "derive_cpu_s"}) EXPECT_GT(run.at(name), 0.0) << name;
    EXPECT_EQ(run.at("shortcut_cpu_s").is_null(), run.at("planner") != "boundary_plus");
    double work = 0.0;
    for (const char* name : {"search_cpu_s", "shortcut_cpu_s", "proof_cpu_s"})
      if (!run.at(name).is_null()) work += run.at(name).get<double>();
    EXPECT_NEAR(work, run.at("cpu_s"), 1e-9 * run.at("cpu_s").get<double>());
    for (const char* name : {"check_s", "check_cpu_s"})
      EXPECT_EQ(run.at(name) == 0.0, run.at("check") == "none") << name;
    ASSERT_EQ(run.at("motion_time_s").is_null(), run.at("valid") == 0);
    if (run.at("valid") == 0) continue;
    EXPECT_GT(run.at("motion_time_s"), 2.5) << "the disc goes 2.5 m at 1 m/s at most";
    EXPECT_LE(run.at("speed_share"), 1.0 + 1e-9);
    EXPECT_LE(run.at("acceleration_share"), 1.0 + 1e-9);
  }
  EXPECT_GT(found[1].at("deadlocks"), 0) << "boundary";
}

TEST_F(CompareColumns, ShowWhetherBoundaryPlusHandedOverToTrees) {
  const auto with_planes = runs("label = 'no trees'"), without = runs("label = 'no planes'");
  for (const Record& run : with_planes) {
    EXPECT_EQ(run.at("handed_over"), 0);
    EXPECT_EQ(run.at("solved_by"), "plane");
  }
  for (const Record& run : without) {
    EXPECT_EQ(run.at("handed_over"), 1);
    EXPECT_EQ(run.at("solved_by"), "hand-over");
    EXPECT_GT(run.at("sampled_share"), 0.0);
  }
  for (const Record& run : runs("planner = 'rrtconnect'")) EXPECT_TRUE(run.at("handed_over").is_null());
}

TEST_F(CompareColumns, HoldOfTeamsWhatTheirFilesHold) {
  const auto found = runs("problems.name = 'past each other'");
  ASSERT_EQ(found.size(), 1U);
  const Record& run = found[0];
  const json team = file(run.at("plan").get<std::string>()), &check = team.at("check");
  EXPECT_EQ(run.at("security_distance_m"), team.at("security_distance_m"));
  EXPECT_EQ(run.at("influence_distance_m"), team.at("influence_distance_m"));
  EXPECT_EQ(run.at("step_bound_m"), team.at("step_bound_m"));
  EXPECT_EQ(run.at("obstacle_speed_m_s"), team.at("greatest_obstacle_speed_m_s"));
  EXPECT_NEAR(run.at("obstacle_speed_m_s"), 0.4, 1e-12);
  EXPECT_EQ(run.at("min_clearance_m"), check.at("least_separation_m"));
  EXPECT_EQ(run.at("speed_share"), check.at("greatest_speed_share"));
  EXPECT_EQ(run.at("acceleration_share"), check.at("greatest_acceleration_share"));
  const auto samples = team.at("robots")[0].at("positions").size();
  EXPECT_NEAR(run.at("motion_time_s"), static_cast<double>(samples - 1) * team.at("period_s").get<double>(),
              1e-9);
  int deadlocks = 0, steps = 0;
  double least = team.at("influence_distance_m");
  for (const json& robot : team.at("robots")) {
    deadlocks += robot.at("deadlocks").get<int>();
    steps += static_cast<int>(robot.at("positions").size()) - 1;
    for (const double separation : robot.at("separations_m")) least = std::min(least, separation);
  }
  EXPECT_EQ(run.at("deadlocks"), deadlocks);
  EXPECT_EQ(run.at("steps_local").get<int>() + run.at("steps_boundary").get<int>(), steps);
  EXPECT_EQ(run.at("least_separation_m"), least);
  EXPECT_EQ(run.at("safe"), 1);
  EXPECT_EQ(run.at("outrun"), "");
}

TEST_F(CompareColumns, AnOutrunRobotIsNotSafeAndOneThatNeverMovedHasNoFigures) {
  const auto found = runs("problems.name IN ('run over', 'on each other')");
  ASSERT_EQ(found.size(), 2U);
  EXPECT_EQ(found[0].at("check"), "outrun");
  EXPECT_EQ(found[0].at("safe"), 0);
  EXPECT_NE(found[0].at("outrun").get<std::string>().find("'train'"), std::string::npos);
  EXPECT_EQ(found[1].at("status"), "start_invalid");
  EXPECT_EQ(found[1].at("safe"), 0);
  for (const char* name :
       {"motion_time_s", "step_bound_m", "speed_share", "deadlocks", "cpu_s", "search_cpu_s", "check_s"})
    EXPECT_TRUE(found[1].at(name).is_null()) << name;
}

/// The page and `--json` hold the same object for each planner.
TEST_F(CompareColumns, ThePageSummarizesWithTheKeysOfTheJson) {
  const std::string html = read_file(folder_->path() / "out" / "report.html");
  const json page = json::parse(PageReader::element(html, "<script type=\"application/json\" id=\"page\">"));
  ASSERT_EQ(page.at("experiments").size(), 2U);
  for (std::size_t e = 0; e < 2; ++e)
    EXPECT_EQ(page["experiments"][e].at("planners"), printed_["experiments"][e].at("planners"));
  const json &alone = printed_["experiments"][0]["planners"][1],
             &together = printed_["experiments"][1]["planners"][0];
  EXPECT_TRUE(alone.at("safe").is_null());
  EXPECT_GT(alone.at("proof_cpu_mean_s"), 0.0);
  EXPECT_TRUE(together.at("search_cpu_mean_s").is_null());
  EXPECT_EQ(together.at("safe"), 1);
  EXPECT_EQ(together.at("outrun"), 1);
}

TEST(CompareTimeLimit, EndsARunOfATeamWhichIsThenNeitherSafeNorSolved) {
  const TemporaryFolder folder;
  const CommandRun run =
      run_command({"compare", "--worst-pages", "0", folder.write("who.yaml", suite), "--out",
                   folder.file("out"), "--json", "--experiments", "together", "--time-limit", "1e-4"});
  ASSERT_EQ(run.status, 0) << run.log;
  const json experiment = json::parse(run.out).at("experiments")[0];
  EXPECT_EQ(experiment.at("time_limit_s"), 1e-4);
  const json& planner = experiment.at("planners")[0];
  EXPECT_EQ(planner.at("solved"), 0);
  EXPECT_EQ(planner.at("safe"), 0);
  EXPECT_EQ(planner.at("refused"), 0);
  EXPECT_EQ(planner.at("unsolved"), (json{{"start_invalid", 1}, {"timed_out", 2}}));
}

TEST(CompareTimeLimit, OfAnExperimentHoldsForItsTeams) {
  const TemporaryFolder folder;
  std::string limited = suite;
  limited.replace(limited.find("    duration: 20"), 16, "    time_limit: 1e-4\n    duration: 20");
  const CommandRun run = run_command({"compare", "--worst-pages", "0", folder.write("who.yaml", limited),
                                      "--out", folder.file("out"), "--json", "--experiments", "together"});
  ASSERT_EQ(run.status, 0) << run.log;
  EXPECT_EQ(json::parse(run.out).at("experiments")[0].at("planners")[0].at("unsolved").at("timed_out"), 2);
}

}  // namespace compare_columns_test
}  // namespace clearway
