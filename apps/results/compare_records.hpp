#pragma once

#include <cstddef>
#include <filesystem>
#include <functional>
#include <map>
#include <mutex>
#include <string>
#include <utility>
#include <vector>

#include "apps/results/compare_results.hpp"

namespace clearway {

/// One part of several that a suite is cut into, from 1: `--shard 2/5`.
struct CompareShard {
  int index = 1, count = 1;
};

/// Whether a problem is of this part, by the places of its experiment in the suite, of its stage there, and
/// its own: both many small stages and one large one are spread evenly.
bool is_in(const CompareShard& shard, std::size_t experiment, std::size_t stage, std::size_t problem);

/// What was asked: results that differ in any of it are of different comparisons.
struct CompareAsked {
  CompareResults results;    ///< its experiments are without problems
  std::string suite_sha256;  ///< of the suite's file
  CompareShard shard;
};

/// In words, what two comparisons do not have in common: "the suite's file", "the seed (1, not 2)"; empty
/// when they are alike, shards and machines apart.
std::string difference(const CompareAsked& a, const CompareAsked& b);

/// What a comparison has found, run by run, in memory and as lines of JSON, from which it can be resumed and
/// merged. One thread writes; any may read meanwhile.
class CompareRecords {
 public:
  struct Problem {
    CompareProblem found;
    bool is_finished = false;
  };
  using Stage = std::vector<Problem>;
  using Sink = std::function<void(const std::string& line)>;

  /// @param sink receives each line, from the first on
  explicit CompareRecords(CompareAsked asked, Sink sink = nullptr);
  /// From the lines that another one wrote. A last line without its end is left out: its process was killed.
  /// @throws std::invalid_argument naming the file and the line that is none of ours.
  static CompareRecords read(const std::filesystem::path& file);
  CompareRecords(CompareRecords&& other) noexcept;

  /// Goes on from what `sink` received: it receives news alone.
  void go_on(Sink sink) { sink_ = std::move(sink); }

  const CompareAsked& asked() const { return asked_; }
  /// Null when nobody opened that stage.
  const Stage* stage(std::size_t experiment, std::size_t stage) const;
  std::vector<std::pair<std::size_t, std::size_t>> stages() const;  ///< experiment and stage, in order
  /// Stage and place there of each problem of experiment(index).
  std::vector<std::pair<std::size_t, std::size_t>> places(std::size_t index) const;
  std::size_t count() const;  ///< of runs
  bool is_drawn_in_vain(std::size_t experiment, std::size_t stage) const;
  /// Why stages have no problems, a sentence each.
  const std::map<std::pair<std::size_t, std::size_t>, std::string>& drawn_in_vain() const { return in_vain_; }
  /// @throws std::runtime_error with the reason when stages were opened and none of them has a problem
  void require_problems() const;

  /// @param in_vain why the stage has no problems; empty: it has some
  void open(std::size_t experiment, std::size_t stage, std::vector<CompareProblem> problems,
            const std::string& in_vain = "");
  /// In the place of an earlier run of the same planner and number.
  void add(std::size_t experiment, std::size_t stage, std::size_t problem, const CompareRun& run);
  void finish(std::size_t experiment, std::size_t stage, std::size_t problem, const std::string& page);
  void add_time(double seconds);

  /// Runs planner by planner and seed by seed, problems in the order of the suite; those without a run are
  /// left out.
  CompareExperiment experiment(std::size_t index) const;
  /// All experiments, or those before `end`, and what is below `folder`: paths to plot, of its plans, and the
  /// pages of worst runs. Stages without problems are among its notes.
  CompareResults results(const std::filesystem::path& folder, std::size_t end = SIZE_MAX) const;
  /// All lines, in that order.
  std::string text() const;

 private:
  void read_line(const std::string& line);
  void write(const std::string& line) const;

  CompareAsked asked_;
  Sink sink_;
  std::map<std::pair<std::size_t, std::size_t>, Stage> stages_;
  std::map<std::pair<std::size_t, std::size_t>, std::string> in_vain_;
  double time_ = 0.0;
  mutable std::mutex mutex_;
};

/// First problem, first run of each planner that found a path: what its plan file says.
std::vector<CompareProfile> profiles_of(const CompareExperiment& experiment,
                                        const std::filesystem::path& folder);

}  // namespace clearway
