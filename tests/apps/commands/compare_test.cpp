#include <gtest/gtest.h>
#include <sqlite3.h>

#include <algorithm>
#include <map>
#include <nlohmann/json.hpp>
#include <set>
#include <sstream>

#include "apps/results/compare_columns.hpp"
#include "mapping/files/cloud_file.hpp"
#include "planning/problem/path_cost.hpp"
#include "planning/robot_files/load_robot.hpp"
#include "tests/apps/page_reader.hpp"
#include "tests/apps/run_command.hpp"
#include "tests/worlds/small_suite.hpp"
#include "tests/worlds/urdf_robots.hpp"

namespace clearway {
namespace compare_test {

namespace fs = std::filesystem;
using Row = std::vector<std::string>;
using Rows = std::vector<Row>;

/// RFC 4180.
Rows csv_rows(const std::string& text) {
  Rows rows(1, Row(1));
  bool quoted = false;
  for (std::size_t i = 0; i < text.size(); ++i) {
    const char c = text[i];
    if (quoted && c == '"' && i + 1 < text.size() && text[i + 1] == '"') {
      rows.back().back() += text[++i];
    } else if (c == '"') {
      quoted = !quoted;
    } else if (!quoted && c == ',') {
      rows.back().emplace_back();
    } else if (!quoted && c == '\n') {
      rows.emplace_back(1);
    } else {
      rows.back().back() += c;
    }
  }
  rows.pop_back();
  return rows;
}

/// A row as a map from the header's names.
std::vector<std::map<std::string, std::string>> records(const std::string& csv) {
  const Rows rows = csv_rows(csv);
  std::vector<std::map<std::string, std::string>> found;
  for (std::size_t r = 1; r < rows.size(); ++r) {
    EXPECT_EQ(rows[r].size(), rows[0].size());
    found.emplace_back();
    for (std::size_t c = 0; c < rows[0].size(); ++c) found.back()[rows[0][c]] = rows[r][c];
  }
  return found;
}

/// One run of the small suite for all tests.
class CompareJob : public testing::Test {
 protected:
  static void SetUpTestSuite() {
    folder_ = std::make_unique<TemporaryFolder>();
    folder_->write("small.yaml", small_suite);
    run_ = compare("one", {"--jobs", "1"});
  }
  static void TearDownTestSuite() { folder_.reset(); }

  static CommandRun compare(const std::string& out, std::vector<std::string> flags) {
    const bool asks = std::find(flags.begin(), flags.end(), "--worst-pages") != flags.end();
    if (out != "one" && !asks)
      flags.insert(flags.end(), {"--worst-pages", "0"});  // they take longer than the runs
    flags.insert(flags.begin(), {"compare", folder_->file("small.yaml"), "--out", folder_->file(out)});
    return run_command(flags);
  }
  static std::string result(const std::string& name, const std::string& out = "one") {
    return read_file(folder_->path() / out / name);
  }

  static std::unique_ptr<TemporaryFolder> folder_;
  static CommandRun run_;
};
std::unique_ptr<TemporaryFolder> CompareJob::folder_;
CommandRun CompareJob::run_;

TEST_F(CompareJob, EndsWithStatus0AndATableAnExperiment) {
  EXPECT_EQ(run_.status, 0) << run_.log;
  EXPECT_NE(run_.out.find("== round: Round a wall"), std::string::npos);
  EXPECT_NE(run_.out.find("coarse       4 / 0 / 6"), std::string::npos) << run_.out;
  EXPECT_NE(run_.out.find("rrtconnect   4 / 4 / 6"), std::string::npos) << run_.out;
  EXPECT_NE(run_.out.find("start_invalid 2"), std::string::npos) << run_.out;
  EXPECT_NE(run_.log.find("clearway: experiment 'round', problem 'blocked': "), std::string::npos)
      << run_.log;
  EXPECT_NE(run_.out.find("report.html"), std::string::npos);
}

TEST_F(CompareJob, PathsThroughTheWallAreSolvedButNotValidWhoeverSaysSo) {
  int coarse = 0;
  for (const auto& run : records(result("results.csv"))) {
    if (run.at("problem") == "blocked") {
      EXPECT_EQ(run.at("status"), "start_invalid");
      EXPECT_EQ(run.at("check"), "none");
      continue;
    }
    EXPECT_EQ(run.at("solved"), "1");
    const bool is_coarse = run.at("label") == "coarse";
    coarse += is_coarse;
    EXPECT_EQ(run.at("valid"), is_coarse ? "0" : "1") << run.at("label") << run.at("contact");
    EXPECT_EQ(run.at("check"), is_coarse ? "refused" : "valid");
    EXPECT_EQ(run.at("contact").empty(), !is_coarse);
    EXPECT_EQ(run.at("certified"), is_coarse ? "0" : "1");
    EXPECT_EQ(run.at("legs"), run.at("problem") == "there and back" ? "2" : "1");
  }
  EXPECT_EQ(coarse, 4);
}

/// What the database says of all runs, as the CSV with that header would.
Rows database_rows(const fs::path& file, const Row& header) {
  sqlite3* database = nullptr;
  EXPECT_EQ(sqlite3_open_v2(file.c_str(), &database, SQLITE_OPEN_READONLY, nullptr), SQLITE_OK);
  std::string sql = "SELECT suites.name, experiments.name, world, problems.name";
  for (std::size_t c = 4; c < header.size(); ++c) sql += ", runs.\"" + header[c] + "\"";
  sql +=
      " FROM runs JOIN problems ON problem = problems.id JOIN experiments ON experiment = experiments.id "
      "JOIN suites ON suite = suites.id ORDER BY runs.id";
  sqlite3_stmt* statement = nullptr;
  EXPECT_EQ(sqlite3_prepare_v2(database, sql.c_str(), -1, &statement, nullptr), SQLITE_OK)
      << sqlite3_errmsg(database);
  Rows rows;
  while (sqlite3_step(statement) == SQLITE_ROW) {
    rows.emplace_back();
    for (int c = 0; c < sqlite3_column_count(statement); ++c) {
      const unsigned char* text = sqlite3_column_text(statement, c);
      rows.back().emplace_back(text == nullptr ? "" : reinterpret_cast<const char*>(text));
    }
  }
  sqlite3_finalize(statement);
  sqlite3_close(database);
  return rows;
}

TEST_F(CompareJob, TheDatabaseHoldsWhatTheCsvHolds) {
  const Rows csv = csv_rows(result("results.csv"));
  const Rows database = database_rows(folder_->path() / "one" / "results.sqlite", csv[0]);
  ASSERT_EQ(database.size() + 1, csv.size());
  EXPECT_EQ(database.size(), 3U * 4U * 2U + 2U);
  std::set<std::string> reals;
  for (const RunColumn& column : run_columns())
    if (std::string(column.sql_type) == "REAL") reals.insert(column.name);
  for (std::size_t r = 0; r < database.size(); ++r) {
    for (std::size_t c = 0; c < csv[0].size(); ++c) {
      const std::string& expected = csv[r + 1][c];
      if (reals.count(csv[0][c]) && !expected.empty()) {  // SQLite prints 15 digits
        EXPECT_NEAR(std::stod(database[r][c]), std::stod(expected), 1e-13 * std::abs(std::stod(expected)));
      } else {
        EXPECT_EQ(database[r][c], expected) << csv[0][c];
      }
    }
  }
}

/// A CSV without its times.
Rows without_times(const std::string& csv) {
  Rows rows = csv_rows(csv);
  for (const char* name : {"time_s", "cpu_s", "search_cpu_s", "shortcut_cpu_s", "proof_cpu_s", "space_cpu_s",
                           "derive_cpu_s", "check_s", "check_cpu_s", "motion_cpu_s"}) {
    const auto column = std::find(rows[0].begin(), rows[0].end(), name) - rows[0].begin();
    EXPECT_LT(column, std::ssize(rows[0])) << name;
    for (Row& row : rows) row.erase(row.begin() + column);
  }
  return rows;
}

TEST_F(CompareJob, TwoJobsFindWhatOneFound) {
  ASSERT_EQ(compare("two", {"--jobs", "2"}).status, 0);
  EXPECT_EQ(without_times(result("results.csv")), without_times(result("results.csv", "two")));
  int plans = 0;
  for (const auto& run : records(result("results.csv"))) {
    auto one = nlohmann::json::parse(result(run.at("plan"))),
         two = nlohmann::json::parse(result(run.at("plan"), "two"));
    EXPECT_EQ(one.at("waypoints").size(), std::stoul(run.at("waypoints")));
    for (auto* plan : {&one, &two}) plan->erase("time_s");
    EXPECT_TRUE(fs::exists(folder_->path() / "one" / std::string(one["map"]["file"]) / "map.ot"))
        << one["map"];
    EXPECT_EQ(one, two) << run.at("plan");
    ++plans;
  }
  EXPECT_EQ(plans, 26);
}

TEST_F(CompareJob, ThePlansAreCheckedAgainOnTheMapThatWasKept) {
  std::set<std::string> maps;
  for (const auto& entry : fs::directory_iterator(folder_->path() / "one" / "maps"))
    maps.insert(entry.path());
  ASSERT_EQ(maps.size(), 1U);
  const auto check = [&](const std::string& plan) {
    return run_command({"check", folder_->file("one/plans/round/there_and_back/" + plan), "--map",
                        *maps.begin(), "--robot", "point"});
  };
  EXPECT_EQ(check("rrtconnect-2.json").status, 0) << check("rrtconnect-2.json").log;
  EXPECT_EQ(check("coarse-1.json").status, 1);
}

TEST_F(CompareJob, OnlyTheChosenPlannersAndExperimentsRun) {
  const CommandRun run = compare("some", {"--planners", "rrtconnect,beam k=10", "--experiments", "round",
                                          "--json", "--seed", "9", "--time-limit", "5"});
  ASSERT_EQ(run.status, 0) << run.log;
  const auto json = nlohmann::json::parse(run.out);
  ASSERT_EQ(json.at("experiments").size(), 1U);
  EXPECT_EQ(json["experiments"][0]["time_limit_s"], 5.0);
  std::set<std::string> labels, seeds;
  for (const auto& each : records(result("results.csv", "some"))) {
    labels.insert(each.at("label"));
    seeds.insert(each.at("seed"));
  }
  EXPECT_EQ(labels, (std::set<std::string>{"beam k=10", "rrtconnect"}));
  EXPECT_EQ(seeds, (std::set<std::string>{"10", "9"}));
}

/// Reads the log as OMPL's ompl_benchmark_statistics does, line by line.
TEST_F(CompareJob, TheLogFollowsOmplsGrammar) {
  std::istringstream log(result("results.log"));
  const auto line = [&] {
    std::string text;
    EXPECT_TRUE(static_cast<bool>(std::getline(log, text)));
    return text;
  };
  const auto starts = [&](const std::string& with) {
    const std::string text = line();
    EXPECT_TRUE(text.starts_with(with)) << text;
  };
  const auto counted = [&](const std::string& what) {
    const std::string text = line();
    EXPECT_TRUE(text.ends_with(what)) << text;
    return std::stod(text);
  };
  starts("Clearway version ");
  EXPECT_EQ(line(), "Experiment small");
  starts("Running on ");
  starts("Starting at ");
  for (int block = 0; block < 2; ++block) {
    EXPECT_EQ(line(), "<<<|");
    line();
    EXPECT_EQ(line(), "|>>>");
  }
  EXPECT_EQ(counted(" is the random seed"), 3);
  EXPECT_EQ(counted(" seconds per run"), 20);
  counted(" MB per run");
  EXPECT_GT(counted(" seconds spent to collect the data"), 0);
  EXPECT_EQ(counted(" enum type"), 1);
  starts("status|");
  const double planners = counted(" planners");
  EXPECT_EQ(planners, 6);
  for (int planner = 0; planner < planners; ++planner) {
    starts(planner < 4 ? "round/" : "swing/");
    for (double n = counted(" common properties"); n > 0; --n) line();
    const double properties = counted(" properties for each run");
    for (double n = properties; n > 0; --n) {
      const std::string kind = line();
      EXPECT_TRUE(kind.ends_with(" REAL") || kind.ends_with(" INTEGER") || kind.ends_with(" BOOLEAN") ||
                  kind.ends_with(" ENUM"))
          << kind;
    }
    const double runs = counted(" runs");
    EXPECT_EQ(runs, planner < 4 ? 6 : 1);
    for (double n = runs; n > 0; --n) {
      const std::string values = line();
      std::size_t separators = 0;
      for (std::size_t at = 0; (at = values.find("; ", at)) != std::string::npos; ++at) ++separators;
      EXPECT_EQ(static_cast<double>(separators), properties);
    }
    EXPECT_EQ(line(), ".");
  }
  EXPECT_EQ(log.peek(), std::char_traits<char>::eof());
}

TEST_F(CompareJob, ThePageHoldsEveryRunAndItsTitleIsText) {
  const std::string html = result("report.html");
  const auto page =
      nlohmann::json::parse(PageReader::element(html, "<script type=\"application/json\" id=\"page\">"));
  EXPECT_EQ(page.at("title"), "A wall and a <swing>");
  EXPECT_NE(html.find("<title>A wall and a &lt;swing></title>"), std::string::npos);
  const auto& round = page.at("experiments")[0];
  EXPECT_EQ(round.at("runs").size(), 24U);
  EXPECT_EQ(round.at("paper"), "What a paper says.");
  EXPECT_EQ(round.at("profiles").size(), 4U);
  for (const auto& run : round.at("runs")) {
    const bool valid = run.at("status") == "solved" && run.at("check") == "valid";
    EXPECT_EQ(run.contains("explanation") && !run["explanation"].get<std::string>().empty(), !valid);
  }
}

TEST_F(CompareJob, TheTableOfAllExperimentsAddsUpWhatTheCsvHolds) {
  const auto page = nlohmann::json::parse(
      PageReader::element(result("report.html"), "<script type=\"application/json\" id=\"page\">"));
  const auto& rows = page.at("overview").at("planners");
  EXPECT_EQ(rows.size(), 5U);
  EXPECT_EQ(page["overview"]["runs"], 7);
  for (const auto& row : rows) {
    int total = 0, solved = 0, valid = 0;
    std::vector<double> times;
    std::set<std::string> experiments;
    for (const auto& run : records(result("results.csv"))) {
      if (run.at("label") != row.at("label")) continue;
      ++total;
      experiments.insert(run.at("experiment"));
      valid += run.at("valid") == "1";
      solved += run.at("solved") == "1";
      if (run.at("solved") == "1") times.push_back(std::stod(run.at("time_s")));
    }
    std::sort(times.begin(), times.end());
    EXPECT_EQ(row.at("total"), total);
    EXPECT_EQ(row.at("solved"), solved);
    EXPECT_EQ(row.at("valid"), valid);
    EXPECT_EQ(row.at("experiments"), experiments.size());
    EXPECT_EQ(row.at("comparable"), row.at("label") == "rrtconnect");
    const double median = 0.5 * (times.at((times.size() - 1) / 2) + times.at(times.size() / 2));
    EXPECT_NEAR(row.at("time_median_s").get<double>(), median, 1e-12);
    EXPECT_LE(row.at("time_p95_s").get<double>(), times.back());
    EXPECT_GE(row.at("time_p95_s").get<double>(), median);
  }
  EXPECT_NE(run_.out.find("== all experiments\n"), std::string::npos);
  EXPECT_NE(run_.out.find("coarse *       1 of 2"), std::string::npos) << run_.out;
  EXPECT_NE(run_.out.find("* ran only some of the 7 runs"), std::string::npos) << run_.out;
}

TEST_F(CompareJob, WorstRunsLinkToPagesThatShowThemWhereverTheFolderIs) {
  const fs::path moved = folder_->path() / "moved";
  fs::copy(folder_->path() / "one", moved, fs::copy_options::recursive);
  const auto page = nlohmann::json::parse(PageReader::element(
      read_file(moved / "report.html"), "<script type=\"application/json\" id=\"page\">"));
  std::set<std::string> files;
  for (const auto& experiment : page.at("experiments")) {
    std::set<std::string> linked;
    EXPECT_FALSE(experiment.at("worst").empty());
    for (const auto& worst : experiment.at("worst")) {
      const auto& run = experiment.at("runs").at(worst.at("run").get<std::size_t>());
      const bool valid = run.at("status") == "solved" && run.at("check") == "valid";
      EXPECT_EQ(worst.at("kind") == "failed", !valid);
      if (!run.contains("page")) continue;
      const std::string link = run.at("page"), file = link.substr(0, link.find('#'));
      linked.insert(worst.at("kind"));
      files.insert(file);
      ASSERT_TRUE(fs::exists(moved / file)) << file;
      const PageReader shown(read_file(moved / file));
      const std::size_t plan = std::stoul(link.substr(link.find("#plan=") + 6));
      EXPECT_EQ(shown.page.at("plans").at(plan).at("name"),
                experiment.at("planners").at(run.at("planner").get<std::size_t>()).at("label"));
    }
    EXPECT_TRUE(linked.contains("slowest"));
    EXPECT_TRUE(linked.contains("tightest"));
    EXPECT_EQ(linked.contains("failed"), experiment.at("name") == "round");
  }
  std::size_t drawn = 0;
  for (const auto& entry : fs::recursive_directory_iterator(moved / "worst"))
    drawn += entry.is_regular_file();
  EXPECT_EQ(drawn, files.size()) << "nothing is drawn that no link leads to";
  EXPECT_LE(drawn, 3U * 2U);
}

TEST_F(CompareJob, NoPageOfAWorstRunIsDrawnWhereNoneIsWanted) {
  ASSERT_EQ(compare("none", {"--worst-pages", "0", "--experiments", "swing"}).status, 0);
  EXPECT_FALSE(fs::exists(folder_->path() / "none" / "worst"));
  EXPECT_EQ(compare("few", {"--worst-pages", "-1"}).status, 2);
}

TEST_F(CompareJob, MistakesAreReportedBeforeAnythingRuns) {
  const auto refusal = [&](const std::string& from, const std::string& to,
                           std::vector<std::string> flags = {}) {
    std::string suite = small_suite;
    suite.replace(suite.find(from), from.size(), to);
    flags.insert(flags.begin(),
                 {"compare", folder_->write("bad.yaml", suite), "--out", folder_->file("bad")});
    const CommandRun run = run_command(flags);
    EXPECT_EQ(run.status, 2) << run.log;
    EXPECT_TRUE(run.complains_in_one_sentence()) << run.log;
    EXPECT_FALSE(fs::exists(folder_->path() / "bad"));
    return run.log;
  };
  const auto expect = [](const std::string& log, const std::string& part) {
    EXPECT_NE(log.find(part), std::string::npos) << log;
  };
  expect(refusal("planner: rrtconnect}", "planner: rrtconect}"), "did you mean 'rrtconnect'?");
  expect(refusal("width: 1,", "widht: 1,"), "experiment 'round', planner 'beam, k = 1'");
  expect(refusal("width: 1,", "width: 0,"), "'width'");
  expect(refusal("plots: [profiles", "plots: [profils"), "did you mean 'profiles'?");
  expect(refusal("robot: planar2", "robot: plannar2"), "experiment 'swing', field 'robot'");
  expect(refusal("start: [2.8, 0.1], goals: [[2.2, 0.4]]", "start: [1], goals: [[2]]"), "experiment 'swing'");
  expect(refusal("{default: not_occupied}", "{tool: not_occupied}"), "tool");
  expect(refusal("seed: 3", "seed: 3", {"--planners", "beam,rrtconect"}), "did you mean 'rrtconnect'?");
  expect(refusal("seed: 3", "seed: 3", {"--experiments", "rond"}), "did you mean 'round'?");
  expect(refusal("seed: 3", "seed: 3", {"--jobs", "0"}), "--jobs");
  expect(run_command({"compare", folder_->file("none.yaml"), "--out", folder_->file("bad")}).log,
         "none.yaml");
  folder_->write("file", "");
  EXPECT_EQ(compare("file", {}).status, 2);
}

/// A wall of points 5 cm apart, in a world that two experiments have: what `plan` says of it, once.
TEST(CompareClouds, AreToldOnConsoleAndPageOnceForEachMap) {
  const TemporaryFolder folder;
  std::vector<Eigen::Vector3f> wall;
  for (int y = -10; y < 10; ++y)
    for (int z = -10; z < 10; ++z)
      wall.push_back({5.0F, 0.025F + 0.05F * static_cast<float>(y), 0.025F + 0.05F * static_cast<float>(z)});
  folder.write("wall.pcd", format_pcd(wall));
  std::string suite =
      "worlds: [{name: cloud, map: wall.pcd}]\nplanners: [{planner: rrtconnect}]\nexperiments:\n";
  for (const char* name : {"a", "b"})
    suite +=
        "  - {name: " + std::string(name) +
        ", robot: point, world: cloud, policies: {default: not_occupied}, problems: [{name: p, start: [0, "
        "0], goals: [[0.5, 0]]}]}\n";
  const CommandRun run =
      run_command({"compare", folder.write("s.yaml", suite), "--out", folder.file("out"), "--json"});
  ASSERT_EQ(run.status, 0) << run.log;
  const auto notes = nlohmann::json::parse(run.out)["notes"].get<std::vector<std::string>>();
  ASSERT_EQ(notes.size(), 1U) << run.out;
  EXPECT_TRUE(notes[0].starts_with("world 'cloud', '")) << notes[0];
  EXPECT_NE(notes[0].find("wall.pcd': the cloud's points are some 50 mm apart"), std::string::npos)
      << notes[0];
  EXPECT_NE(notes[0].find("with --cloud-resolution and --save makes a map of others"), std::string::npos);
  const std::size_t said = run.log.find("note: " + notes[0] + "\n");
  ASSERT_NE(said, std::string::npos) << run.log;
  EXPECT_EQ(run.log.find("the cloud's points", said + 60 + notes[0].size()), std::string::npos) << run.log;
  EXPECT_NE(read_file(folder.file("out/report.html")).find("the cloud's points are some 50 mm apart"),
            std::string::npos);
  const CommandRun merged =
      run_command({"compare", "merge", folder.file("out"), "--out", folder.file("merged")});
  EXPECT_EQ(merged.status, 0) << merged.log;
  EXPECT_NE(merged.log.find("note: " + notes[0]), std::string::npos) << merged.log;
}

/// An arm that swings in a vertical plane, with and without a load, by the cost of the path that it took.
TEST(CompareCosts, AreReckonedWithThePayloadAndGravityOfTheExperiment) {
  const auto run_with = [](const std::string& keys) {
    const TemporaryFolder folder;
    std::string suite = small_suite;
    suite.replace(suite.find("    robot: planar2"), 18, "    robot: planar2\n" + keys);
    const CommandRun run = run_command({"compare", folder.write("s.yaml", suite), "--out", folder.file("out"),
                                        "--experiments", "swing", "--planners", "beam"});
    EXPECT_EQ(run.status, 0) << run.log;
    auto found = records(read_file(folder.path() / "out" / "results.csv")).at(0);
    const auto plan = nlohmann::json::parse(read_file(folder.path() / "out" / found.at("plan")));
    const Robot robot = load_robot("planar2");
    const auto gravity = plan.at("gravity").get<std::vector<double>>();
    const PathCost cost(robot, {.gravity = Eigen::Vector3d(gravity.data()),
                                .payload_mass = plan.at("payload_kg").get<double>()});
    std::vector<Configuration> path;
    for (const auto& q : plan.at("waypoints")) path.emplace_back(Eigen::Vector2d(q[0], q[1]));
    EXPECT_NEAR(std::stod(found.at("cost_joules")), cost(path), 0.05 * cost(path)) << keys;
    const std::string html = read_file(folder.path() / "out" / "report.html");
    EXPECT_EQ(html.find("payload 3 kg") != std::string::npos, keys.find("payload") != std::string::npos);
    return std::stod(found.at("cost_joules"));
  };
  const double usual = run_with(""), upright = run_with("    gravity: [0, -9.81, 0]\n"),
               loaded = run_with("    gravity: [0, -9.81, 0]\n    payload: 3\n");
  EXPECT_GT(std::abs(upright - usual), 0.01 * usual);
  EXPECT_GT(std::abs(loaded - upright), 0.01 * upright);
}

TEST(CompareCosts, OfARobotWithoutMassesAreNotKnownAndItIsSaidWhy) {
  const TemporaryFolder folder;
  folder.write("arm.urdf", worlds::arm_with_finger());
  const std::string suite = folder.write(
      "s.yaml",
      "worlds: [{name: w, resolution: 0.1, volumes: [{label: v, strokes: [{balls: [[0, 0, 0, 0.3]]}]}]}]\n"
      "planners: [{planner: rrtconnect}]\n"
      "experiments: [{name: e, robot: arm.urdf, world: w, policies: {default: not_occupied},\n"
      "  problems: [{name: p, start: [0, 0, 0], goals: [[0.3, 0.2, 0]]}]}]\n");
  const CommandRun run = run_command({"compare", suite, "--out", folder.file("out"), "--worst-pages", "0"});
  ASSERT_EQ(run.status, 0) << run.log;
  EXPECT_NE(run.log.find("note: The robot's file gives link 'lower' and 1 other that move no mass "
                         "(<inertial>), so costs of robot "),
            std::string::npos)
      << run.log;
}

}  // namespace compare_test
}  // namespace clearway
