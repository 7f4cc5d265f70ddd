// Scan insertion: ours in `compatible` mode against OctoMap's insertPointCloud, same mode, same scans, one
// thread. OctoMap inserts the first `runs` scans only (at 1 cm it takes seconds each); the ratio is that of
// the medians over these, the p99 of ours that of all scans.

#include <octomap/OcTree.h>

#include <algorithm>
#include <cstdio>
#include <optional>

#include "apps/bench/bench.hpp"
#include "apps/bench/insert_heap.hpp"
#include "apps/bench/scan_source.hpp"
#include "mapping/scans/scan_rays.hpp"

namespace clearway::bench {
namespace {

constexpr std::size_t frames = 60;  ///< of ours, for the p99

struct Figures {
  double ours = 0.0, peer = 0.0, p99 = 0.0;  ///< CPU ms a scan
};

ScanInsertion insertion_of(bool discretize, int threads) {
  ScanInsertion insertion;
  insertion.discretize = discretize;
  insertion.threads = threads;
  return insertion;
}

Figures measure(const ScanSource& source, std::size_t scans, int runs, double resolution, double max_range,
                bool discretize) {
  FusedTree tree(resolution);
  octomap::OcTree stock(resolution);
  ScanWorkspace workspace;
  const ScanInsertion insertion = insertion_of(discretize, 1);
  std::vector<double> ours, peer;
  for (std::size_t i = 0; i < scans; ++i) {
    const Scan scan = source(i);
    ours.push_back(
        1e3 * cpu_seconds([&] { insert_scan(tree, scan, {.max_range = max_range}, insertion, workspace); }));
    if (i < static_cast<std::size_t>(runs))
      peer.push_back(1e3 * insert_stock(stock, scan, max_range, discretize));
  }
  return {median({ours.begin(), ours.begin() + runs}), median(peer), quantile(ours, 0.99)};
}

/// Wall-clock time of one thread over that of two: medians over the same scans, in turn.
double speed_up_of_two_threads(const ScanSource& source, int runs, double resolution, bool discretize) {
  FusedTree trees[2] = {FusedTree(resolution), FusedTree(resolution)};
  ScanWorkspace workspaces[2];
  std::vector<double> seconds[2];
  for (int i = 0; i < runs; ++i) {
    const Scan scan = source(static_cast<std::size_t>(i));
    for (int which = 0; which < 2; ++which) {
      const double begin = wall_time();
      insert_scan(trees[which], scan, {}, insertion_of(discretize, which + 1), workspaces[which]);
      seconds[which].push_back(wall_time() - begin);
    }
  }
  return median(seconds[0]) / median(seconds[1]);
}

nlohmann::ordered_json row_of(const Figures& figures) {
  return {{"ours_ms", figures.ours},
          {"octomap_ms", figures.peer},
          {"ratio", figures.peer / figures.ours},
          {"p99_ms", figures.p99}};
}

std::string name_of(bool discretize, double resolution) {
  char name[64];
  std::snprintf(name, sizeof(name), "%s_%g_cm", discretize ? "discretized" : "full", 100.0 * resolution);
  return name;
}

nlohmann::ordered_json heap_figures(double resolution, const ScanSource& source) {
  nlohmann::ordered_json json;
  for (const HeapContent content : {HeapContent::rays, HeapContent::surfaces}) {
    const HeapBytes ours = heap_of_ours(resolution, 5, source, content);
    const HeapBytes stock = heap_of_stock(resolution, 5, source, content);
    json[content == HeapContent::rays ? "ray_filled" : "surfaces_only"] = {
        {"ours_after_insertion", ours.after_insertion},
        {"octomap_after_insertion", stock.after_insertion},
        {"ours_after_loading", ours.after_loading},
        {"octomap_after_loading", stock.after_loading},
        {"loaded_ratio", ours.after_loading / stock.after_loading}};
  }
  return json;
}

/// Points and mean range of a scan.
nlohmann::ordered_json extent_of(const Scan& scan) {
  double sum = 0.0;
  std::size_t count = 0;
  for (const Eigen::Vector3f& point : scan.points) {
    if (!point.allFinite()) continue;
    sum += double{point.norm()};
    ++count;
  }
  return {{"points", count}, {"mean_range_m", sum / static_cast<double>(count)}};
}

/// Rows of both modes at each resolution. Returns the figures of the first.
Figures add_rows(const ScanSource& source, const std::vector<double>& resolutions, int runs,
                 std::size_t least_scans, const std::string& prefix, nlohmann::ordered_json& detail) {
  const std::size_t scans = std::max(least_scans, static_cast<std::size_t>(runs));
  std::optional<Figures> first;
  for (const double resolution : resolutions) {
    for (const bool discretize : {true, false}) {
      const Figures figures = measure(source, scans, runs, resolution, 0.0, discretize);
      if (!first) first = figures;
      auto& row = detail[prefix + name_of(discretize, resolution)] = row_of(figures);
      row["two_threads"] = speed_up_of_two_threads(source, runs, resolution, discretize);
    }
  }
  return *first;
}

}  // namespace

BenchResult bench_insert(const BenchOptions& options) {
  const bool generated = options.input.empty();
  std::vector<double> resolutions{0.02, 0.05, 0.01};
  if (options.resolution > 0.0) resolutions = {options.resolution};
  nlohmann::ordered_json detail;
  Figures headline;
  if (generated) {
    const ScanSource room = room_frames(frames), desk = desk_frames(frames);
    detail["heap_bytes_a_node"] = heap_figures(resolutions[0], room);
    headline = add_rows(room, resolutions, options.runs, frames, "", detail);
    resolutions.erase(std::remove(resolutions.begin(), resolutions.end(), 0.05), resolutions.end());
    detail["desk_frames"] = extent_of(desk(0));
    if (!resolutions.empty()) add_rows(desk, resolutions, options.runs, frames, "desk_", detail);
    for (const bool discretize : {true, false}) {
      const std::string mode = discretize ? "lidar_discretized" : "lidar_full";
      detail[mode + "_5_cm_20_m"] = row_of(measure(lidar_turns(), static_cast<std::size_t>(options.runs),
                                                   options.runs, 0.05, 20.0, discretize));
    }
  } else {
    const ScanSource source = scans_of(options.input);
    detail["first_scan"] = extent_of(source(0));
    detail["heap_bytes_a_node"] = heap_figures(resolutions[0], source);
    headline = add_rows(source, resolutions, options.runs, 1, "", detail);
  }
  return {headline.ours, headline.peer, "OctoMap insertPointCloud", "CPU ms per scan", true,
          options.runs,  detail};
}

}  // namespace clearway::bench
