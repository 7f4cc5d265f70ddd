#include <sqlite3.h>

#include <memory>
#include <nlohmann/json.hpp>
#include <stdexcept>

#include "apps/compare_results.hpp"
#include "mapping/save_file.hpp"

namespace clearway {
namespace {

using Json = nlohmann::ordered_json;

constexpr const char* schema = R"sql(
PRAGMA journal_mode = OFF;
PRAGMA synchronous = OFF;
CREATE TABLE suites(
  id INTEGER PRIMARY KEY, name TEXT NOT NULL, title TEXT, file TEXT, seed TEXT, jobs INTEGER, version TEXT,
  git_commit TEXT, host TEXT, processor TEXT, date TEXT, time_s REAL);
CREATE TABLE experiments(
  id INTEGER PRIMARY KEY, suite INTEGER NOT NULL REFERENCES suites(id), name TEXT NOT NULL, title TEXT, paper TEXT,
  notes TEXT, robot TEXT, scale REAL, policies TEXT, padding_m REAL, time_limit_s REAL, runs INTEGER,
  joints TEXT, plots TEXT);
CREATE TABLE problems(
  id INTEGER PRIMARY KEY, experiment INTEGER NOT NULL REFERENCES experiments(id), name TEXT NOT NULL, world TEXT,
  map_file TEXT, map_sha256 TEXT, resolution_m REAL, start TEXT, goals TEXT);
CREATE TABLE runs(
  id INTEGER PRIMARY KEY, problem INTEGER NOT NULL REFERENCES problems(id), run INTEGER, seed TEXT, label TEXT NOT NULL,
  planner TEXT NOT NULL, options TEXT, certified INTEGER, status TEXT, solved INTEGER, valid INTEGER,
  "check" TEXT, legs INTEGER, cost_joules REAL, length_rad REAL, steps INTEGER, waypoints INTEGER,
  min_clearance_m REAL, configurations INTEGER, edges INTEGER, time_s REAL, plan TEXT, contact TEXT,
  explanation TEXT);
CREATE INDEX runs_of_problem ON runs(problem);
BEGIN;
)sql";

/// An open database that throws what SQLite says.
class Database {
 public:
  explicit Database(const std::filesystem::path& file) {
    const int status = sqlite3_open(file.c_str(), &handle_);
    if (status != SQLITE_OK) {
      const std::string why = sqlite3_errmsg(handle_);
      sqlite3_close(handle_);
      throw std::runtime_error("cannot write the database: " + why);
    }
  }
  ~Database() { sqlite3_close(handle_); }
  Database(const Database&) = delete;
  Database& operator=(const Database&) = delete;

  void execute(const char* sql) {
    require(sqlite3_exec(handle_, sql, nullptr, nullptr, nullptr) == SQLITE_OK);
  }

  /// Adds a row with these values, in the order of the columns after `id`. Returns its id.
  std::int64_t insert(const std::string& table, const std::vector<Json>& values) {
    std::string sql = "INSERT INTO " + table + " VALUES (NULL";
    for (std::size_t i = 0; i < values.size(); ++i) sql += ",?";
    sqlite3_stmt* raw = nullptr;
    require(sqlite3_prepare_v2(handle_, (sql + ")").c_str(), -1, &raw, nullptr) == SQLITE_OK);
    const std::unique_ptr<sqlite3_stmt, int (*)(sqlite3_stmt*)> statement(raw, sqlite3_finalize);
    for (std::size_t i = 0; i < values.size(); ++i) bind(raw, static_cast<int>(i) + 1, values[i]);
    require(sqlite3_step(raw) == SQLITE_DONE);
    return sqlite3_last_insert_rowid(handle_);
  }

 private:
  void bind(sqlite3_stmt* statement, int at, const Json& value) {
    if (value.is_number_float()) {
      require(sqlite3_bind_double(statement, at, value.get<double>()) == SQLITE_OK);
    } else if (value.is_number() || value.is_boolean()) {
      const auto number = value.is_boolean() ? std::int64_t{value.get<bool>()} : value.get<std::int64_t>();
      require(sqlite3_bind_int64(statement, at, number) == SQLITE_OK);
    } else {
      const std::string text = value.is_string() ? value.get<std::string>()
                                                 : value.dump(-1, ' ', false, Json::error_handler_t::replace);
      require(sqlite3_bind_text(statement, at, text.c_str(), static_cast<int>(text.size()),
                                SQLITE_TRANSIENT) == SQLITE_OK);
    }
  }
  void require(bool done) {
    if (!done) throw std::runtime_error(std::string("cannot write the database: ") + sqlite3_errmsg(handle_));
  }

  sqlite3* handle_ = nullptr;
};

Json numbers(const Configuration& q) { return std::vector<double>(q.begin(), q.end()); }

void insert_problem(Database& database, std::int64_t experiment_id, const CompareExperiment& experiment,
                    const CompareProblem& problem) {
  Json goals = Json::array();
  for (const Configuration& goal : problem.goals) goals.push_back(numbers(goal));
  const std::int64_t id =
      database.insert("problems", {experiment_id, problem.name, problem.world, problem.map_file,
                                   problem.map_sha256, problem.resolution, numbers(problem.start), goals});
  for (const CompareRun& run : problem.runs) {
    const ComparePlanner& who = experiment.planners[run.planner];
    database.insert("runs", {id,
                             run.number,
                             std::to_string(run.seed),
                             who.label,
                             who.planner,
                             Json(who.options),
                             who.certified,
                             std::string(to_string(run.status)),
                             run.is_solved(),
                             run.is_valid(),
                             run.check,
                             run.legs,
                             run.cost,
                             run.length,
                             run.steps,
                             run.waypoints,
                             run.min_clearance,
                             run.configurations,
                             run.edges,
                             run.time,
                             run.plan_file,
                             run.contact,
                             run.explanation});
  }
}

void insert_all(Database& database, const CompareResults& results) {
  const std::int64_t suite =
      database.insert("suites", {results.suite, results.title, results.file, std::to_string(results.seed),
                                 results.jobs, results.version, results.commit, results.host,
                                 results.processor, results.date, results.time});
  for (const CompareExperiment& experiment : results.experiments) {
    const SuiteExperiment& setup = experiment.setup;
    const std::int64_t id = database.insert(
        "experiments", {suite, setup.name, setup.title, setup.paper, setup.notes, experiment.robot_file,
                        experiment.scale, Json(setup.policies), setup.padding, experiment.time_limit,
                        setup.runs, Json(experiment.joints), Json(setup.plots)});
    for (const CompareProblem& problem : experiment.problems) {
      insert_problem(database, id, experiment, problem);
    }
  }
}

}  // namespace

void save_database(const CompareResults& results, const std::filesystem::path& file) {
  save_file(file, [&](const std::filesystem::path& temporary) {
    std::filesystem::remove(temporary);  // left by a run that was killed
    Database database(temporary);
    database.execute(schema);
    insert_all(database, results);
    database.execute("COMMIT");
  });
}

}  // namespace clearway
