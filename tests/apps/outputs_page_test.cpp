// apps/OUTPUTS.md against the program, both ways: what the sources and real outputs hold is on the page, and
// what is on the page is in the sources. run_command does the same for whatever JSON any test prints.
#include "tests/apps/outputs_page.hpp"

#include <gtest/gtest.h>
#include <sqlite3.h>

#include <memory>
#include <sstream>

#include "apps/results/compare_diff.hpp"
#include "tests/apps/run_command.hpp"
#include "tests/worlds/small_scene.hpp"

namespace clearway {
namespace outputs_page_test {

namespace fs = std::filesystem;
using Json = nlohmann::json;
using Names = std::vector<std::string>;

TEST(OutputsPage, TellsWhatIsMissingLeftOverAndOfAnotherType) {
  const OutputsPage page(
      "## a\n\n| key | type | meaning |\n|---|---|---|\n| `one`, `two` | number, m | |\n"
      "| `list[]`: [part](#a-part) | | |\n| `list` | list | |\n| `any.*` | text or null | |\n"
      "| `any` | object | absent: nothing |\n"
      "\n## A part\n\n| key | type | meaning |\n|---|---|---|\n| `name`, `count` | text, count | |\n");
  const auto complaints = [&](const std::string& text) { return page.complaints(Json::parse(text), "a"); };
  using Complaints = std::set<std::string>;
  EXPECT_EQ(complaints(R"({"one": 1, "two": 2.5, "list": [{"name": "x", "count": 0}], "any": {"x": null}})"),
            Complaints{});
  EXPECT_EQ(complaints(R"({"one": 1, "list": [], "three": 3})"),
            (Complaints{"a lacks two, which is described as always there", "a.three is not described"}));
  EXPECT_EQ(complaints(R"({"one": "1", "two": null, "list": [{"name": "x", "count": -1}]})"),
            (Complaints{"a.list[].count is no count: -1", "a.one is no number: \"1\"",
                        "a.two is no number: null"}));
  EXPECT_EQ(page.keys("a"), (Names{"one", "two", "list", "any.*", "any"}));
}

/// Sources of the program that may write something.
std::vector<fs::path> sources() {
  std::vector<fs::path> files;
  for (const char* floor : {"mapping", "planning", "tracking", "datasets", "apps"})
    for (const auto& entry : fs::recursive_directory_iterator(fs::path(CLEARWAY_SOURCE_DIR) / floor))
      if (entry.path().extension() == ".cpp" && entry.path().parent_path().filename() != "bench")
        files.push_back(entry.path());
  return files;
}

/// What stands in quotes or between commas, as in a line of columns, and the columns of the database.
std::set<std::string> names_in_sources() {
  std::set<std::string> names;
  for (const fs::path& file : sources()) {
    std::string text = read_file(file);
    std::replace(text.begin(), text.end(), '\\', ',');
    std::replace(text.begin(), text.end(), '"', ',');
    std::istringstream pieces(text);
    for (std::string piece; std::getline(pieces, piece, ',');) {
      names.insert(piece);
      piece.erase(0, piece.find_first_not_of(" \n"));
      if (const std::size_t end = piece.find(' '); end != std::string::npos)
        for (const char* type : {" TEXT", " REAL", " INTEGER"})
          if (piece.compare(end, std::string(type).size(), type) == 0) names.insert(piece.substr(0, end));
    }
  }
  return names;
}

/// The names along a key of the page: of "at[].clearance_m.*" the first two.
Names names_of(const std::string& key) {
  Names names;
  std::istringstream text(key);
  for (std::string name; std::getline(text, name, '.');) {
    while (name.ends_with("[]")) name.resize(name.size() - 2);
    if (name != "*") names.push_back(name);
  }
  return names;
}

TEST(OutputsPage, NamesNothingThatTheSourcesDoNotWrite) {
  const std::set<std::string> known = names_in_sources();
  std::set<std::string> missing;
  std::size_t count = 0;
  for (const std::string& section : OutputsPage::written().sections())
    for (const std::string& key : OutputsPage::written().keys(section))
      for (const std::string& name : names_of(key)) {
        ++count;
        std::string begin = name.substr(0, name.find('*'));  // of a name that the sources put together
        const bool is_whole = begin == name;
        while (!is_whole && begin.ends_with('_')) begin.pop_back();
        if (!known.contains(begin) && !known.contains(begin + '_')) missing.insert(section + ": " + name);
      }
  EXPECT_GT(count, 1000U);
  EXPECT_EQ(missing, std::set<std::string>{});
}

/// What OUTPUTS.md names, and the words of the pages that it leaves the rest to.
class Reference {
 public:
  Reference() {
    for (const std::string& section : OutputsPage::written().sections())
      for (const std::string& key : OutputsPage::written().keys(section))
        for (const std::string& name : names_of(key))
          (name.find('*') == std::string::npos ? known_ : begins_).insert(name.substr(0, name.find('*')));
    add_words("apps/OUTPUTS.md", "`\\w+`");
    for (const char* page :
         {"datasets/FORMATS.md", "datasets/suites/FORMAT.md", "apps/compare/YOUR_PLANNER.md"})
      add_words(page, "\\w+");
  }
  bool has(const std::string& key) const {
    return known_.contains(key) || std::any_of(begins_.begin(), begins_.end(), [&](const std::string& begin) {
             return begin.size() > 1 && key.starts_with(begin);
           });
  }

 private:
  void add_words(const std::string& page, const std::string& pattern) {
    const std::regex word(pattern);
    const std::string text = read_file(fs::path(CLEARWAY_SOURCE_DIR) / page);
    for (std::sregex_iterator at(text.begin(), text.end(), word), end; at != end; ++at) {
      std::string found = at->str();
      std::erase(found, '`');
      known_.insert(found);
    }
  }

  std::set<std::string> known_, begins_;
};

/// Files whose JSON is inside of a page, or between processes of the program.
const std::set<std::string> not_for_others = {"page_evidence.cpp", "page_timeline.cpp", "report_page.cpp",
                                              "compare_page.cpp", "problem_server.cpp"};

TEST(OutputsPage, HasEveryKeyThatTheSourcesWrite) {
  const Reference reference;
  const std::regex key(R"rx(\{"([a-z][a-z0-9_]*)",|\["([a-z][a-z0-9_]*)"\])rx");
  std::set<std::string> missing;
  std::size_t count = 0;
  for (const fs::path& file : sources()) {
    const std::string text = read_file(file);
    if (not_for_others.contains(file.filename()) || text.find("<nlohmann/json.hpp>") == std::string::npos)
      continue;
    for (std::sregex_iterator at(text.begin(), text.end(), key), end; at != end; ++at) {
      const std::string name = (*at)[1].matched ? (*at)[1] : (*at)[2];
      ++count;
      if (!reference.has(name)) missing.insert(file.filename().string() + ": " + name);
    }
  }
  EXPECT_GT(count, 900U);
  EXPECT_EQ(missing, std::set<std::string>{}) << "describe them on apps/OUTPUTS.md, or where that page says";
}

TEST(OutputsPage, ExplainsTheColumnsOfTables) {
  const std::string text = read_file(CLEARWAY_SOURCE_DIR "/apps/OUTPUTS.md");
  const std::size_t begin = text.find("\n## Tables of compare");
  const std::string tables = text.substr(begin, text.find("\n## ", begin + 1) - begin);
  CompareExperiment alone, together;
  together.setup.teams.emplace();
  for (const auto& table : {summary_table(alone), summary_table(together), diff_table({})})
    for (const std::string& column : table.front())
      EXPECT_TRUE(tables.find(column) != std::string::npos) << column;
}

/// The names of the first line of a CSV; none of ours has commas in it.
Names columns_of(const std::string& text) {
  Names columns;
  std::istringstream line(text.substr(0, text.find('\n')));
  for (std::string name; std::getline(line, name, ',');) columns.push_back(name);
  return columns;
}

/// A small recording, and jobs that leave files behind.
class OutputsOfJobs : public testing::Test {
 protected:
  static void SetUpTestSuite() {
    folder_ = std::make_unique<TemporaryFolder>();
    const std::string query = "    start: [0, 0]\n    goals: [[0.3, 0]]\n    allow_outside: [all]\n";
    folder_->write("setup.yaml", small_setup.substr(0, small_setup.rfind('}')) +
                                     ", tracking_error: 0.012}\n"
                                     "robot: {name: point, base: [0, 0, 1, 0, 0, 0]}\n"
                                     "queries:\n  - name: across\n" +
                                     query +
                                     "    planners: [rrtconnect, boundary]\n"
                                     "    policies: {default: not_occupied}\n"
                                     "    loads: [{name: box, box: [0.1, 0.1, 0.1], link: base}]\n"
                                     "  - name: in_vain\n" +
                                     query + "    planners: [beam]\n    policies: {default: painted}\n");
    folder_->write("load.yaml", "{name: rod, box: [0.1, 0.1, 0.1], link: base}");
    const CommandRun simulated = run_command({"simulate", folder_->write("scene.yaml", small_scene), "--out",
                                              folder_->file("r.rawlog"), "--json"});
    ASSERT_EQ(simulated.status, exit_done) << simulated.log;
    const CommandRun replayed = run_command(
        {"replay", folder_->file("r.rawlog"), "--resolution", "0.05", "--out", folder_->file("out")});
    ASSERT_EQ(replayed.status, exit_no) << replayed.log;
  }
  static void TearDownTestSuite() { folder_.reset(); }

  static std::string file(const std::string& name) { return folder_->file(name); }

  static void expect_described(const Json& json, const std::string& section, const std::string& where) {
    EXPECT_EQ(OutputsPage::written().complaints(json, section), std::set<std::string>{}) << where;
  }
  /// A JSON file, or all of a folder.
  static void expect_described(const std::string& name, const std::string& section) {
    std::vector<fs::path> files{*folder_ / name};
    if (fs::is_directory(files.front()))
      files.assign(fs::recursive_directory_iterator(*folder_ / name), fs::recursive_directory_iterator());
    std::erase_if(files, [](const fs::path& each) { return each.extension() != ".json"; });
    EXPECT_FALSE(files.empty()) << name;
    for (const fs::path& each : files) expect_described(Json::parse(read_file(each)), section, each);
  }
  /// JSON line by line.
  static void expect_lines_described(const std::string& text, const std::string& section) {
    std::istringstream lines(text);
    for (std::string line; std::getline(lines, line);) expect_described(Json::parse(line), section, line);
  }

  static std::unique_ptr<TemporaryFolder> folder_;
};
std::unique_ptr<TemporaryFolder> OutputsOfJobs::folder_;

TEST_F(OutputsOfJobs, AReplayLeavesWhatThePageSays) {
  expect_described("out/report.json", "report.json");
  expect_described("out/plans", "plan.json");
  expect_described("out/queries.json", "queries.json");
  EXPECT_EQ(columns_of(read_file(file("out/painted.csv"))), OutputsPage::written().keys("painted.csv"));
  const std::set<std::string> files = {".clearway_files", "map.ot",       "painted.csv", "plans",
                                       "provenance.bin",  "queries.json", "report.html", "report.json"};
  std::set<std::string> found;
  for (const auto& entry : fs::directory_iterator(*folder_ / "out")) found.insert(entry.path().filename());
  EXPECT_EQ(found, files) << "another file is described on the page, and named here";
}

TEST_F(OutputsOfJobs, ASessionLeavesWhatThePageSays) {
  const std::string before = R"({"time": 0.3, "action": )";
  folder_->write(
      "events.jsonl",
      R"({"time": 0, "action": "paint_on"})"
      "\n" +
          before + "\"paint_off\"}\n" + before +
          R"("robot", "robot": "point", "base": [0, 0, 1], "policies": {"default": "not_occupied"}})"
          "\n" +
          before +
          R"("attach", "load": {"name": "rod", "box": [0.1, 0.1, 0.1], "link": "base"}})"
          "\n" +
          before + "\"play\"}\n" + before +
          R"("start", "q": "0,0"})"
          "\n" +
          before +
          R"("goal", "q": "0.3,0"})"
          "\n" +
          before + R"("plan", "name": "over", "planner": "rrtconnect"})");
  const CommandRun run =
      run_command({"teach", file("r.rawlog"), "--events", file("events.jsonl"), "--headless", "--resolution",
                   "0.05", "--out", file("taught"), "--json"});
  const Json taught = Json::parse(run.out).at("teaching");
  EXPECT_EQ(taught.at("events").size(), 8U) << run.log;
  EXPECT_EQ(taught.at("plans").size(), 1U);
  expect_described("taught/plans", "plan.json");
  expect_described("taught/session/session.json", "session.json");
}

TEST_F(OutputsOfJobs, APlanAndItsTrajectoriesHoldWhatThePageSays) {
  const CommandRun run = run_command(
      {"plan",           "--map",           file("out"),    "--robot",      "point",           "--base=0,0,1",
       "--start=0,0",    "--goal=0.3,0",    "--policy",     "not_occupied", "--allow-outside", "all",
       "--attach",       file("load.yaml"), "--trajectory", "json",         file("t.json"),    "--trajectory",
       "ros-json",       file("ros.json"),  "--trajectory", "csv",          file("t.csv"),     "--out",
       file("plan.json")});
  ASSERT_EQ(run.status, exit_done) << run.log;
  expect_described("plan.json", "plan.json");
  expect_described("t.json", "Trajectory, json");
  expect_described("ros.json", "Trajectory, ros-json");
  const Names columns = {"time_s", "x", "y", "x velocity", "y velocity", "x acceleration", "y acceleration"};
  EXPECT_EQ(columns_of(read_file(file("t.csv"))), columns) << "with a load that rides all the way: no event";
  for (const char* checked : {"plan.json", "ros.json"})  // as JSON, which run_command holds against the page
    EXPECT_NE(run_command({"check", file(checked), "--map", file("out"), "--robot", "point", "--json"}).out,
              "");
}

TEST_F(OutputsOfJobs, VerdictsOfTheGateHoldWhatThePageSays) {
  std::istringstream in(R"({"id":"a","times":[0,0.1],"positions":[[0,0],[0.05,0]]})"
                        "\nnonsense\n"
                        R"({"id":3,"times":[0.2,0.4],"positions":[[0.05,0],[0.2,0]]})");
  std::ostringstream out, log;
  Console console(out, log, false, &in);
  const Names terms = {"gate",     "--map",        file("out"),       "--robot", "point", "--base=0,0,0.05",
                       "--policy", "not_occupied", "--allow-outside", "all"};
  EXPECT_EQ(run_command_line(terms, console), exit_no) << log.str();
  expect_lines_described(out.str(), "gate");
}

TEST_F(OutputsOfJobs, PosesHaveTheColumnsOfThePage) {
  const CommandRun run =
      run_command({"track", file("r.rawlog"), "--csv", file("poses.csv"), "--json", file("poses.json")});
  ASSERT_EQ(run.status, exit_done) << run.log;
  expect_described("poses.json", "track");
  Names columns = columns_of(read_file(file("poses.csv")));
  const auto is_of_covariance = [](const std::string& name) { return name.size() == 3 && name[0] == 'c'; };
  EXPECT_EQ(std::count_if(columns.begin(), columns.end(), is_of_covariance), 21);
  *std::find_if(columns.begin(), columns.end(), is_of_covariance) = "c*";
  std::erase_if(columns, is_of_covariance);
  EXPECT_EQ(columns, OutputsPage::written().keys("poses.csv"));
}

TEST_F(OutputsOfJobs, AnImportLeavesWhatThePageSays) {
  const std::string sets = CLEARWAY_SOURCE_DIR "/datasets/suites/foreign/";
  const CommandRun run = run_command({"import", "mbm", sets + "scene0001.yaml", sets + "request0001.yaml",
                                      sets + "request0002.yaml", "--robot", "panda", "--resolution", "0.1",
                                      "--out", file("imported"), "--json"});
  ASSERT_EQ(run.status, exit_done) << run.log;
  expect_described("imported/import.json", "import.json");
}

/// Of each table of the database, in their order, as the page spells them.
Names columns_of_database(const std::string& file) {
  sqlite3* database = nullptr;
  EXPECT_EQ(sqlite3_open_v2(file.c_str(), &database, SQLITE_OPEN_READONLY, nullptr), SQLITE_OK);
  sqlite3_stmt* row = nullptr;
  const char* const sql =
      "SELECT m.name || '.' || c.name FROM sqlite_master m, pragma_table_info(m.name) c WHERE m.type = "
      "'table'";
  EXPECT_EQ(sqlite3_prepare_v2(database, sql, -1, &row, nullptr), SQLITE_OK) << sqlite3_errmsg(database);
  Names columns;
  while (sqlite3_step(row) == SQLITE_ROW)
    columns.emplace_back(reinterpret_cast<const char*>(sqlite3_column_text(row, 0)));
  sqlite3_finalize(row);
  sqlite3_close(database);
  return columns;
}

/// What OMPL's log says that it holds of each run.
Names properties_of_log(const std::string& text) {
  const std::string head = " properties for each run\n";
  const std::size_t first = text.find(head) + head.size();
  std::istringstream lines(text.substr(first, text.find(" runs\n", first) - first));
  Names properties;
  for (std::string line; std::getline(lines, line);)
    if (line.find_first_not_of("0123456789") != std::string::npos) properties.push_back(line);
  return properties;
}

TEST_F(OutputsOfJobs, AComparisonHasTheColumnsOfThePage) {
  folder_->write("suite.yaml", R"(
worlds:
  - name: wall
    resolution: 0.05
    solids: [{name: wall, box: [0.1, 1.5, 0.1], pose: [1.05, 0.15, 0, 0, 0, 0]}]
    sensors: [[-1, 0, 0.02], [3, 0, 0.02]]
experiments:
  - name: alone
    robot: point
    world: wall
    problems:
      - {name: round, start: [0, 0], goals: [[2.5, 0.05]]}
      - {name: blocked, start: [1.05, 0], goals: [[2.5, 0.05]]}
    policies: {default: not_occupied}
    planners: [{planner: boundary_plus}, {planner: rrtconnect}]
  - name: together
    planners: [{planner: boundary}]
    duration: 3
    teams:
      - name: one
        robots: [{name: left, robot: point, start: [0, 0], goal: [0.5, 0]}]
        moving:
          - shape: {name: ball, sphere: 0.1}
            path: [{time: 0, pose: [1, 2, 0, 0, 0, 0]}, {time: 1, pose: [1, -2, 0, 0, 0, 0]}]
)");
  const CommandRun run =
      run_command({"compare", file("suite.yaml"), "--worst-pages", "0", "--out", file("results"), "--json"});
  ASSERT_EQ(run.status, exit_done) << run.log;
  const OutputsPage& page = OutputsPage::written();
  const Names columns = columns_of(read_file(file("results/results.csv"))),
              of_runs = page.keys("results.csv");
  EXPECT_EQ(columns, of_runs);
  Names of_database = page.keys("results.sqlite");
  for (auto column = of_runs.begin() + 4; column != of_runs.end(); ++column)
    of_database.push_back("runs." + *column);
  Names found = columns_of_database(file("results/results.sqlite"));
  std::sort(of_database.begin(), of_database.end());
  std::sort(found.begin(), found.end());
  EXPECT_EQ(found, of_database);
  EXPECT_EQ(properties_of_log(read_file(file("results/results.log"))), page.keys("results.log"));
  expect_lines_described(read_file(file("results/runs.jsonl")), "runs.jsonl");
  expect_described("results/plans", "plan.json");
  expect_described("results/teams", "teams");
}

}  // namespace outputs_page_test
}  // namespace clearway
