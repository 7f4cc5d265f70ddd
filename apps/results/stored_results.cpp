#include "apps/results/stored_results.hpp"

#include <sqlite3.h>

#include <array>
#include <cmath>
#include <memory>
#include <stdexcept>

#include "mapping/system/input_file.hpp"
#include "mapping/system/plain_text.hpp"

namespace clearway {
namespace {

namespace fs = std::filesystem;

// A database is a program: of views, triggers and generated columns. These bound what it may take.
constexpr std::size_t largest_results = std::size_t{1} << 30U;
constexpr int longest_text = 16'000'000;                    ///< bytes
constexpr int steps_a_look = 1'000'000, most_looks = 2000;  ///< of SQLite's machine
constexpr std::size_t most_rows = 5'000'000;

void guard(sqlite3* database, int& looks) {
  for (const int forbidden :
       {SQLITE_DBCONFIG_ENABLE_VIEW, SQLITE_DBCONFIG_ENABLE_TRIGGER, SQLITE_DBCONFIG_TRUSTED_SCHEMA})
    sqlite3_db_config(database, forbidden, 0, nullptr);
  sqlite3_db_config(database, SQLITE_DBCONFIG_DEFENSIVE, 1, nullptr);
  sqlite3_limit(database, SQLITE_LIMIT_LENGTH, longest_text);
  const auto look = [](void* count) { return static_cast<int>(++*static_cast<int*>(count) > most_looks); };
  sqlite3_progress_handler(database, steps_a_look, look, &looks);
}

/// An open database, and one question to it.
class StoredQuery {
 public:
  StoredQuery(const fs::path& file, const char* sql) : file_(file) {
    if (InputFile(file, "results").size() > largest_results) refuse();
    sqlite3* raw = nullptr;
    const int opened = sqlite3_open_v2(file.c_str(), &raw, SQLITE_OPEN_READONLY, nullptr);
    database_.reset(raw);
    sqlite3_stmt* statement = nullptr;
    if (opened != SQLITE_OK) refuse();
    guard(raw, looks_);
    if (sqlite3_prepare_v2(raw, sql, -1, &statement, nullptr) != SQLITE_OK) refuse();
    statement_.reset(statement);
  }
  bool next() {
    const int status = sqlite3_step(statement_.get());
    if ((status != SQLITE_ROW && status != SQLITE_DONE) || ++rows_ > most_rows) refuse();
    return status == SQLITE_ROW;
  }
  std::string text(int column) const {
    const unsigned char* bytes = sqlite3_column_text(statement_.get(), column);
    return bytes == nullptr ? "" : reinterpret_cast<const char*>(bytes);
  }
  double number(int column) const { return sqlite3_column_double(statement_.get(), column); }
  double number_or_nan(int column) const {
    return sqlite3_column_type(statement_.get(), column) == SQLITE_NULL ? std::nan("") : number(column);
  }
  int whole(int column) const { return sqlite3_column_int(statement_.get(), column); }

 private:
  [[noreturn]] void refuse() const {
    throw std::invalid_argument("'" + plain(file_.string()) +
                                "' cannot be read: expected a results.sqlite of `clearway compare`");
  }
  fs::path file_;
  int looks_ = 0;
  std::size_t rows_ = 0;
  std::unique_ptr<sqlite3, int (*)(sqlite3*)> database_{nullptr, sqlite3_close};
  std::unique_ptr<sqlite3_stmt, int (*)(sqlite3_stmt*)> statement_{nullptr, sqlite3_finalize};
};

/// A column of SHA-256 of the experiments, by name; none of older results, which lack it.
std::map<std::string, std::string> digests(const fs::path& file, const std::string& column) {
  std::map<std::string, std::string> found;
  const std::string is_there = "SELECT 1 FROM pragma_table_info('experiments') WHERE name = '" + column + "'";
  if (!StoredQuery(file, is_there.c_str()).next()) return found;
  const std::string all = "SELECT name, " + column + " FROM experiments";
  StoredQuery experiments(file, all.c_str());
  while (experiments.next()) found[experiments.text(0)] = experiments.text(1);
  return found;
}

}  // namespace

StoredResults load_stored_results(const fs::path& given) {
  StoredResults results;
  results.file = fs::is_directory(given) ? given / "results.sqlite" : given;
  StoredQuery suites(results.file, "SELECT host, processor, jobs, seed FROM suites");
  while (suites.next()) {
    results.host = suites.text(0);
    results.processor = suites.text(1);
    results.jobs = suites.text(2);
    results.seed = suites.text(3);
  }
  StoredQuery maps(results.file,
                   "SELECT experiments.name, problems.name, map_sha256, start, goals FROM problems JOIN "
                   "experiments ON experiment = experiments.id");
  while (maps.next()) {
    results.maps[{maps.text(0), maps.text(1)}] = maps.text(2);
    results.ends[{maps.text(0), maps.text(1)}] = maps.text(3) + maps.text(4);
  }
  constexpr std::array names{"scale", "policies", "padding", "payload", "gravity", "time limit"};
  StoredQuery experiments(results.file,
                          "SELECT name, scale, policies, padding_m, payload_kg, gravity, time_limit_s FROM "
                          "experiments");
  while (experiments.next())
    for (std::size_t i = 0; i < names.size(); ++i)
      results.settings[experiments.text(0)][names[i]] = experiments.text(static_cast<int>(i) + 1);
  results.robots = digests(results.file, "robot_sha256");
  results.problems = digests(results.file, "problems_sha256");
  StoredQuery runs(
      results.file,
      "SELECT experiments.name, label, problems.name, run, runs.seed, valid, cpu_s, cost_joules, "
      "length_rad, status, options, planner FROM runs JOIN problems ON problem = problems.id JOIN "
      "experiments ON "
      "experiment "
      "= experiments.id ORDER BY runs.id");
  while (runs.next()) {
    const std::pair name(runs.text(0), runs.text(1));
    results.options[name] = runs.text(10);
    if (runs.text(11) == "external") results.externals.insert(name.second);
    results.runs[name][{runs.text(2), runs.whole(3), runs.text(4)}] = {
        runs.whole(5) != 0, runs.text(9) == "timed_out" || runs.text(9) == "hung", runs.number(6),
        runs.number_or_nan(7), runs.number(8)};
  }
  return results;
}

}  // namespace clearway
