#pragma once

#include <cstddef>
#include <filesystem>
#include <functional>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

namespace clearway::bench {

/// Flags of `clearway_bench NAME`.
struct BenchOptions {
  std::filesystem::path input;  ///< recording, map or cloud to measure on; empty: generated
  double resolution = 0.0;      ///< metres; 0: the benchmark's own
  int runs = 10;                ///< interleaved runs, >= 1
};

/// One thing measured against its named peer on the same input in the same run.
struct BenchResult {
  double ours = 0.0, peer = 0.0;
  std::string peer_name, unit;
  bool smaller_is_better = true;
  int runs = 0;
  nlohmann::ordered_json detail;
};

using Benchmark = BenchResult (*)(const BenchOptions&);

/// Median of numbers; 0 for none.
double median(std::vector<double> values);
/// The p-th quantile (0 to 1), nearest rank.
double quantile(std::vector<double> values, double p);

/// CPU time of this process so far (all its threads), seconds.
double cpu_time();
/// Wall clock, seconds.
double wall_time();

/// CPU seconds of one call.
double cpu_seconds(const std::function<void()>& work);

/// malloc puts off sorting what was freed until someone asks for a large block. Call it before a measurement,
/// so that neither side pays for what the other one freed.
void settle_heap();

/// Medians of `runs` interleaved pairs (ours, peer, ours, ...). Each function makes one run, set-up included,
/// and returns the figure that it measured inside.
struct Pair {
  double ours = 0.0, peer = 0.0;
};
Pair interleave(int runs, const std::function<double()>& ours, const std::function<double()>& peer);

// One benchmark a file.
BenchResult bench_insert(const BenchOptions& options);
BenchResult bench_erosion(const BenchOptions& options);
BenchResult bench_field(const BenchOptions& options);
BenchResult bench_field_update(const BenchOptions& options);
BenchResult bench_cast_ray(const BenchOptions& options);
BenchResult bench_snapshot(const BenchOptions& options);
BenchResult bench_checks(const BenchOptions& options);
BenchResult bench_load(const BenchOptions& options);
BenchResult bench_paint(const BenchOptions& options);
BenchResult bench_bodies(const BenchOptions& options);
BenchResult bench_provenance(const BenchOptions& options);
BenchResult bench_beam(const BenchOptions& options);
BenchResult bench_qp(const BenchOptions& options);
BenchResult bench_control(const BenchOptions& options);
BenchResult bench_live(const BenchOptions& options);

}  // namespace clearway::bench
