#pragma once

#include <filesystem>
#include <map>
#include <set>
#include <string>
#include <tuple>
#include <utility>

namespace clearway {

/// A run as far as it is compared.
struct StoredRun {
  bool is_valid = false;
  bool is_of_clock = false;  ///< a clock ended it: chance
  double cpu = 0.0, cost = 0.0, length = 0.0;
};
using RunKey = std::tuple<std::string, int, std::string>;  ///< problem, number, seed
using StoredRuns = std::map<RunKey, StoredRun>;

/// What a `results.sqlite` holds, as far as it is compared.
struct StoredResults {
  std::filesystem::path file;
  std::string host, processor, jobs, seed;
  std::map<std::pair<std::string, std::string>, std::string> maps;  ///< SHA-256, by experiment and problem
  std::map<std::string, std::string> robots, problems;              ///< SHA-256, by experiment; may lack all
  /// Of each experiment what it asked, by what sentences call it, as its database has it; the same of
  /// problems.
  std::map<std::string, std::map<std::string, std::string>> settings;
  std::map<std::pair<std::string, std::string>, std::string> ends;     ///< start and goals
  std::map<std::pair<std::string, std::string>, StoredRuns> runs;      ///< by experiment and label
  std::map<std::pair<std::string, std::string>, std::string> options;  ///< in force, JSON; the same
  std::set<std::string> externals;  ///< labels of programs of others, which need not follow a seed
};

/// Reads a `results.sqlite`, or a folder's, with bounds on what its tables, views and triggers may take.
/// @throws std::invalid_argument naming the file that is no such database
StoredResults load_stored_results(const std::filesystem::path& given);

}  // namespace clearway
