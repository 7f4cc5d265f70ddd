#pragma once

#include <filesystem>
#include <functional>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "apps/bench/page/markdown.hpp"

namespace clearway::bench {

/// Flags of `clearway_bench NAME`.
struct BenchOptions {
  std::filesystem::path input;  ///< recording, map or cloud to measure on; empty: generated
  double resolution = 0.0;      ///< metres; 0: the benchmark's own
  int runs = 0;                 ///< interleaved runs; 0: the benchmark's own (Entry::runs)
  std::function<void(const std::string&)> progress;  ///< gets what is under way; may be empty

  void say(const std::string& what) const {
    if (progress) progress(what);
  }
  /// "run 3 of 10", counted from 0.
  void say_run(int run, int of) const { say("run " + std::to_string(run + 1) + " of " + std::to_string(of)); }
};

/// One thing measured against its named peer on the same input in the same run.
struct BenchResult {
  double ours = 0.0, peer = 0.0;
  std::string peer_name, unit;
  bool smaller_is_better = true;
  int runs = 0;
  nlohmann::ordered_json detail;

  std::string compared{};       ///< a sentence or two: what with which peer on which input, and what to doubt
  std::vector<Table> tables{};  ///< medians, other quantiles where they belong, ratios
  std::string also{};      ///< figures beside `ours`, in its unit, for the line of a summary; may be empty
  std::string no_ratio{};  ///< why `ours` and `peer` make no ratio; empty: they do

  /// What the line of a summary says of its figures.
  std::string units() const { return also.empty() ? unit : unit + " (" + also + ")"; }
  /// Above 1: ours is better.
  double ratio() const { return smaller_is_better ? peer / ours : ours / peer; }
};

using Benchmark = std::function<BenchResult(const BenchOptions&)>;

/// A benchmark as the program knows it. At its default number of runs it ends within a minute.
struct Entry {
  std::string name, what;
  int runs = 10;
  Benchmark run;
};

}  // namespace clearway::bench
