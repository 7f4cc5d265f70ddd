#pragma once

#include <functional>
#include <vector>

#include "apps/bench/page/measure.hpp"
#include "apps/bench/page/result.hpp"
#include "apps/console/quantile.hpp"

namespace clearway::bench {

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
BenchResult bench_motion(const BenchOptions& options);
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
BenchResult bench_sweep(const BenchOptions& options);

}  // namespace clearway::bench
