#pragma once

#include <ostream>

#include "apps/bench/page/machine.hpp"
#include "apps/bench/page/result.hpp"

namespace clearway::bench {

/// What became of one benchmark.
struct Outcome {
  std::string name, what;
  BenchResult result;
  std::string failure;  ///< why it ended without a result; empty: it has one
  double seconds = 0.0;
  MachineLoad before, after;
};

/// Where the progress of benchmarks is shown: a line for each, and in it, or in lines of their own, the runs.
struct Progress {
  std::ostream& log;
  bool is_terminal = false;  ///< the run under way is shown at the end of the line, again and again
  bool each_run = false;     ///< a line for each run
};

/// One after the other. One that throws does not stop the others.
/// @param options for all of them; runs == 0 stands for each one's own number
/// @param done gets each outcome at once
std::vector<Outcome> run_benchmarks(const std::vector<Entry>& entries, const BenchOptions& options,
                                    Progress progress, const std::function<void(const Outcome&)>& done);

/// 0: all have a result; 1: some failed.
int exit_status(const std::vector<Outcome>& outcomes);

}  // namespace clearway::bench
