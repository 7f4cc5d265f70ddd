#pragma once

#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "apps/compare/compare_run.hpp"
#include "apps/console/console.hpp"
#include "mapping/system/atomic_folder.hpp"

namespace clearway {

/// A comparison that is run into a folder, experiment after experiment. What each run finds is in the folder
/// when the next one begins. A signal (interruption.hpp) leaves tables of what is finished there
/// and on the console, and the next session may go on with them.
class CompareSession {
 public:
  /// @param folder where all goes; with `resumes`, what is there is gone on with
  /// @throws std::invalid_argument naming what differs when what is there is of another comparison
  CompareSession(AtomicFolder& folder, CompareAsked asked, bool resumes);

  /// Runs what is left, prints a table for each experiment, and saves the results.
  /// @throws std::runtime_error when generators found no problem for any experiment; and as run_experiment
  CompareResults run(const Suite& suite, const std::vector<PreparedExperiment>& prepared,
                     const CompareChoice& choice, Console& console);

 private:
  static CompareRecords begin(AtomicFolder& folder, CompareAsked asked, bool resumes);
  void append(const std::string& line);

  AtomicFolder& folder_;
  CompareRecords records_;
  FileDescriptor file_;
  int lines_ = 0;  ///< appended
};

/// What --resume finds whole in `folder`: nothing is left to run. Empty when it is not there or lacks some of
/// the runs that are asked for, as `runs` counts them, or a comparison is under way beside it.
/// @throws std::invalid_argument naming what differs when it is of another comparison
std::optional<CompareResults> finished_results(const std::filesystem::path& folder, const CompareAsked& asked,
                                               const std::function<std::size_t(const CompareRecords&)>& runs);

/// Every experiment's table, then their sums where there are several.
void print_results(const CompareResults& results, Console& console);
void print_experiment(const CompareExperiment& experiment, Console& console);
/// What stands over several experiments: effects of resolution, and all of them added up.
void print_sums(const CompareResults& results, Console& console);

/// Sentences about runs that ended without an answer, with the id that repeats each.
std::vector<std::string> runs_without_answer(const CompareResults& results);

/// @throws std::invalid_argument when an interrupted comparison into this folder has finished runs: another
/// one would remove them.
void require_nothing_unfinished(const std::filesystem::path& folder);

}  // namespace clearway
