#pragma once

#include <functional>
#include <vector>

#include "apps/bench/page/result.hpp"

namespace clearway::bench {

/// Median of numbers; 0 for none.
double median(std::vector<double> values);

/// CPU time of this process so far (all its threads), seconds.
double cpu_time();
/// Wall clock, seconds.
double wall_time();

/// CPU seconds of one call.
double cpu_seconds(const std::function<void()>& work);

/// malloc puts off sorting what was freed until someone asks for a large block. Call it before a measurement,
/// so that neither side pays for what the other one freed.
void settle_heap();

/// Medians of `options.runs` interleaved pairs (ours, peer, ours, ...). Each function makes one run, set-up
/// included, and returns the figure that it measured inside.
struct Pair {
  double ours = 0.0, peer = 0.0;

  double ratio() const { return peer / ours; }  ///< of times
};
Pair interleave(const BenchOptions& options, const std::function<double()>& ours,
                const std::function<double()>& peer);

}  // namespace clearway::bench
