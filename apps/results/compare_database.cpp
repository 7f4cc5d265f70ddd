#include <sqlite3.h>

#include <cmath>
#include <memory>
#include <new>
#include <nlohmann/json.hpp>
#include <stdexcept>

#include "apps/console/number_or_null.hpp"
#include "apps/results/compare_columns.hpp"
#include "mapping/system/atomic_file.hpp"

namespace clearway {
namespace {

using Json = nlohmann::ordered_json;

constexpr const char* schema = R"sql(
CREATE TABLE suites(
  id INTEGER PRIMARY KEY, name TEXT NOT NULL, title TEXT, file TEXT, seed TEXT, jobs INTEGER, version TEXT,
  git_commit TEXT, host TEXT, processor TEXT, date TEXT, time_s REAL);
CREATE TABLE experiments(
  id INTEGER PRIMARY KEY, suite INTEGER NOT NULL REFERENCES suites(id), name TEXT NOT NULL, title TEXT, paper TEXT,
  notes TEXT, robot TEXT, scale REAL, policies TEXT, padding_m REAL, payload_kg REAL, gravity TEXT, time_limit_s REAL, runs INTEGER,
  joints TEXT, plots TEXT, robot_sha256 TEXT, problems_sha256 TEXT);
CREATE TABLE problems(
  id INTEGER PRIMARY KEY, experiment INTEGER NOT NULL REFERENCES experiments(id), name TEXT NOT NULL, world TEXT,
  map_file TEXT, map_sha256 TEXT, resolution_m REAL, start TEXT, goals TEXT);
)sql";

/// The table of runs has the columns that the CSV has.
std::string runs_schema() {
  std::string sql =
      "CREATE TABLE runs(id INTEGER PRIMARY KEY, problem INTEGER NOT NULL REFERENCES problems(id)";
  for (const RunColumn& column : run_columns()) sql += ", \"" + column.name + "\" " + column.sql_type;
  return sql + "); CREATE INDEX runs_of_problem ON runs(problem); BEGIN;";
}

/// A database in memory that throws what SQLite says. Its file is written as any other: SQLite's own writes
/// would leave a journal behind and a cut database after a kill.
class Database {
 public:
  Database() {
    const int status = sqlite3_open(":memory:", &handle_);
    if (status != SQLITE_OK) {
      const std::string why = sqlite3_errmsg(handle_);
      sqlite3_close(handle_);
      throw std::runtime_error("cannot make the database: " + why);
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

  /// The bytes of the database's file.
  std::string bytes() const {
    sqlite3_int64 size = 0;
    const std::unique_ptr<unsigned char, void (*)(void*)> bytes(sqlite3_serialize(handle_, "main", &size, 0),
                                                                sqlite3_free);
    if (!bytes) throw std::bad_alloc();
    return {reinterpret_cast<const char*>(bytes.get()), static_cast<std::size_t>(size)};
  }

 private:
  void bind(sqlite3_stmt* statement, int at, const Json& value) {
    if (value.is_null()) {
      require(sqlite3_bind_null(statement, at) == SQLITE_OK);
    } else if (value.is_number_float()) {
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
    if (!done) throw std::runtime_error(std::string("cannot make the database: ") + sqlite3_errmsg(handle_));
  }

  sqlite3* handle_ = nullptr;
};

Json cell_json(const CompareCell& cell) {
  if (const auto* whole = std::get_if<std::int64_t>(&cell)) return *whole;
  if (const auto* real = std::get_if<double>(&cell)) return number_or_null(*real);
  if (const auto* text = std::get_if<std::string>(&cell)) return *text;
  return nullptr;
}

Json numbers(const Configuration& q) { return std::vector<double>(q.begin(), q.end()); }

void insert_problem(Database& database, std::int64_t experiment_id, const CompareExperiment& experiment,
                    const CompareProblem& problem) {
  Json goals = Json::array();
  for (const Configuration& goal : problem.goals) goals.push_back(numbers(goal));
  const std::int64_t id =
      database.insert("problems", {experiment_id, problem.name, problem.world, problem.map_file,
                                   problem.map_sha256, problem.resolution, numbers(problem.start), goals});
  for (const CompareRun& run : problem.runs) {
    std::vector<Json> row{id};
    for (const RunColumn& column : run_columns())
      row.push_back(cell_json(column.cell(run, experiment.planners[run.planner])));
    database.insert("runs", row);
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
        "experiments",
        {suite, setup.name, setup.title, setup.paper, setup.notes, experiment.robot_file, experiment.scale,
         Json(setup.policies), setup.padding.value_or(0.0), setup.payload, numbers(setup.gravity),
         number_or_null(experiment.time_limit), setup.runs, Json(experiment.joints), Json(setup.plots),
         experiment.robot_sha256, experiment.problems_sha256});
    for (const CompareProblem& problem : experiment.problems) {
      insert_problem(database, id, experiment, problem);
    }
  }
}

}  // namespace

void save_database(const CompareResults& results, const std::filesystem::path& file) {
  Database database;
  database.execute(schema);
  database.execute(runs_schema().c_str());
  insert_all(database, results);
  database.execute("COMMIT");
  save_file(file, database.bytes());
}

}  // namespace clearway
