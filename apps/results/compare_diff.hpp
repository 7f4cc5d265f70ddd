#pragma once

#include <cstddef>
#include <filesystem>
#include <string>
#include <vector>

#include "apps/results/compare_statistics.hpp"

namespace clearway {

/// What became of one planner in one experiment, over the runs that both results have: same problem, number
/// and seed.
struct DiffRow {
  std::string experiment, planner;
  std::size_t runs = 0;
  std::size_t lost = 0, won = 0;     ///< runs that were valid and are not; the other way
  std::size_t lost_to_clock = 0;     ///< of those lost: a clock ended them
  std::size_t other_paths = 0;       ///< valid in both, with another cost or length: another path
  double success_p = 1.0;            ///< sign test of problems with fewer and with more valid runs
  PairedFigure cpu = {}, cost = {};  ///< new against old: `ratio` 1.1 is 10 % more
  bool is_external = false;          ///< a program of others, whose runs of one seed may differ by chance
  bool is_too_small = false;         ///< no change of some problems could have a p value that is small enough
  std::vector<std::string> worse = {}, better = {};  ///< what is beyond noise, in words
};

struct CompareDiff {
  std::vector<DiffRow> rows;
  std::vector<std::string> notes;  ///< what makes the two hard to compare, a sentence each
  bool is_worse() const;
  /// "Nothing is worse beyond noise.", and what too few problems leave open.
  std::string verdict() const;
};

/// Reads two `results.sqlite` (or folders of results), and reports what changed beyond noise: a difference in
/// success, CPU time or path cost whose p value, corrected for the number of rows, is below 0.05; of CPU time
/// only 5 % or more, as machines drift. Beyond noise without a test are, where none was won, runs lost to no
/// clock (the seeds are the same) and six or more lost to one, but for external planners, and CPU time that
/// is twice or half in the median, and more or less on each of three problems or more.
/// @throws std::invalid_argument naming the file that is no such database, or that has no run in common
CompareDiff compare_diff(const std::filesystem::path& before, const std::filesystem::path& after);

/// A header, then a row for each planner of each experiment.
std::vector<std::vector<std::string>> diff_table(const CompareDiff& diff);
std::string to_json(const CompareDiff& diff);

}  // namespace clearway
