#pragma once

#include <functional>
#include <vector>

#include "apps/bench/page/result.hpp"
#include "apps/console/quantile.hpp"

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

// One benchmark a file.
BenchResult bench_insert(const BenchOptions& options);
BenchResult bench_erosion(const BenchOptions& options);
BenchResult bench_field(const BenchOptions& options);
BenchResult bench_field_update(const BenchOptions& options);
BenchResult bench_cast_ray(const BenchOptions& options);
BenchResult bench_snapshot(const BenchOptions& options);
BenchResult bench_checks(const BenchOptions& options);
BenchResult bench_edges(const BenchOptions& options);
BenchResult bench_plan(const BenchOptions& options);
BenchResult bench_load(const BenchOptions& options);
BenchResult bench_paint(const BenchOptions& options);
BenchResult bench_bodies(const BenchOptions& options);
BenchResult bench_provenance(const BenchOptions& options);
BenchResult bench_beam(const BenchOptions& options);
BenchResult bench_qp(const BenchOptions& options);
BenchResult bench_control(const BenchOptions& options);
BenchResult bench_live(const BenchOptions& options);
BenchResult bench_gate(const BenchOptions& options);
BenchResult bench_teach(const BenchOptions& options);
BenchResult bench_overlay(const BenchOptions& options);

}  // namespace clearway::bench
