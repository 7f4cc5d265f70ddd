// Scan insertion: ours in `compatible` mode against OctoMap's insertPointCloud, same mode, one thread. Both
// get the same frames of a sequence, each frame once, in turn.

#include <octomap/OcTree.h>

#include <algorithm>

#include "apps/bench/bench.hpp"
#include "apps/bench/insert_heap.hpp"
#include "apps/bench/worlds/scan_source.hpp"
#include "mapping/scans/scan_rays.hpp"

namespace clearway::bench {
namespace {

using Json = nlohmann::ordered_json;

/// One way to insert a sequence.
struct Insertion {
  std::string what;  ///< the sequence
  double resolution = 0.02, max_range = 0.0;
  bool discretize = true;

  std::string name() const {
    return what + ", " + length_text(resolution) + ", " + (discretize ? "discretized" : "full");
  }
  ScanInsertion mode(int threads) const {
    ScanInsertion insertion;
    insertion.discretize = discretize;
    insertion.threads = threads;
    return insertion;
  }
};

/// CPU ms of each scan; and, inserted again into trees of their own, the wall clock on one thread and on two.
struct Inserted {
  std::vector<double> ours, peer, wall[2];

  double ratio() const { return median(peer) / median(ours); }
  double two_threads() const { return median(wall[0]) / median(wall[1]); }
  Json json() const {
    return {{"scans", ours.size()},
            {"ours_ms", median(ours)},
            {"octomap_ms", median(peer)},
            {"ratio", ratio()},
            {"ours_at_most_ms", quantile(ours, 1.0)},
            {"octomap_at_most_ms", quantile(peer, 1.0)},
            {"two_threads", two_threads()}};
  }
  std::vector<std::string> row(const std::string& name) const {
    return {name,
            std::to_string(ours.size()),
            figure(median(ours)),
            figure(median(peer)),
            figure(ratio()),
            figure(quantile(ours, 1.0)),
            figure(quantile(peer, 1.0)),
            figure(two_threads())};
  }
};

/// A single cloud goes into empty trees, `runs` times; a sequence into one tree, frame by frame.
Inserted insert_all(const BenchOptions& options, const ScanSource& source, const Insertion& how) {
  struct Trees {
    explicit Trees(double resolution)
        : one(resolution), first(resolution), second(resolution), stock(resolution) {}
    FusedTree one, first, second;
    octomap::OcTree stock;
  };
  const bool is_single = source.count == 1;
  const std::size_t scans = is_single ? static_cast<std::size_t>(options.runs)
                                      : std::min(source.count, static_cast<std::size_t>(options.runs));
  ScanWorkspace workspace;
  Inserted inserted;
  auto trees = std::make_unique<Trees>(how.resolution);
  for (std::size_t i = 0; i < scans; ++i) {
    options.say(how.name() + ", scan " + std::to_string(i + 1) + " of " + std::to_string(scans));
    if (is_single) trees = std::make_unique<Trees>(how.resolution);
    const Scan scan = source(is_single ? 0 : i);
    const ScanFilter filter{.max_range = how.max_range};
    inserted.ours.push_back(
        1e3 * cpu_seconds([&] { insert_scan(trees->one, scan, filter, how.mode(1), workspace); }));
    inserted.peer.push_back(1e3 * insert_stock(trees->stock, scan, how.max_range, how.discretize));
    for (int threads : {1, 2}) {
      const double begin = wall_time();
      insert_scan(threads == 1 ? trees->first : trees->second, scan, filter, how.mode(threads), workspace);
      inserted.wall[threads - 1].push_back(wall_time() - begin);
    }
  }
  return inserted;
}

struct NamedSource {
  std::string name;
  ScanSource source;
  std::vector<double> resolutions;
  double max_range = 0.0;
  bool both_modes = true;
};

/// Heap bytes per node of the tree of some scans.
Table heap_table(const BenchOptions& options, const NamedSource& of, Json& detail) {
  const double resolution = options.resolution > 0.0 ? options.resolution : 0.02;
  const ScanSource& source = of.source;
  const std::size_t scans = std::min<std::size_t>(3, source.count);
  Table table{"Heap bytes per node, " + std::to_string(scans) + " scans of " + of.name + " at " +
                  length_text(resolution) + ":",
              {"tree", "ours", "OctoMap", "ratio"},
              {}};
  for (const HeapContent content : {HeapContent::rays, HeapContent::surfaces}) {
    const HeapBytes ours = heap_of_ours(resolution, scans, source, content);
    const HeapBytes stock = heap_of_stock(resolution, scans, source, content);
    const bool is_full = content == HeapContent::rays;
    const std::string name = is_full ? "rays fill the map" : "surfaces alone";
    const auto row = [&](const char* when, double HeapBytes::*bytes) {
      table.rows.push_back({name + ", " + when, figure(ours.*bytes), figure(stock.*bytes),
                            figure(stock.*bytes / ours.*bytes)});
    };
    row("after insertion", &HeapBytes::after_insertion);
    row("after loading", &HeapBytes::after_loading);
    detail[is_full ? "ray_filled" : "surfaces_only"] = {
        {"ours_after_insertion", ours.after_insertion},
        {"octomap_after_insertion", stock.after_insertion},
        {"ours_after_loading", ours.after_loading},
        {"octomap_after_loading", stock.after_loading},
        {"loaded_ratio", ours.after_loading / stock.after_loading}};
  }
  return table;
}

/// Points and mean range of a scan.
std::string extent_of(const Scan& scan) {
  double sum = 0.0;
  std::size_t count = 0;
  for (const Eigen::Vector3f& point : scan.points) {
    if (!point.allFinite()) continue;
    sum += double{point.norm()};
    ++count;
  }
  return figure(static_cast<double>(count)) + " points at " +
         figure(sum / static_cast<double>(std::max<std::size_t>(count, 1))) + " m";
}

std::vector<NamedSource> sources_of(const BenchOptions& options) {
  if (!options.input.empty())
    return {{options.input.filename().string(), scans_of(options.input), {0.02, 0.05, 0.01}}};
  const auto count = static_cast<std::size_t>(options.runs);
  return {{"room", room_frames(count), {0.02, 0.05}},
          {"desk", desk_frames(count), {0.02, 0.01}},
          {"lidar to 20 m", lidar_turns(count), {0.1}, 20.0, false}};
}

}  // namespace

BenchResult bench_insert(const BenchOptions& options) {
  BenchResult result{0, 0, "OctoMap insertPointCloud", "CPU ms per scan", true, options.runs, {}};
  Table table{"CPU ms per scan on one thread; `2 threads`: by how much they shorten the wall clock of ours:",
              {"scans", "count", "ours", "OctoMap", "ratio", "ours at most", "OctoMap at most", "2 threads"},
              {}};
  std::string extents;
  const std::vector<NamedSource> sources = sources_of(options);
  options.say("memory");  // first: see insert_heap.hpp
  const Table heap = heap_table(options, sources[sources.size() / 2], result.detail["heap_bytes_a_node"]);
  for (const NamedSource& one : sources) {
    extents += (extents.empty() ? "" : "; ") + one.name + " " + extent_of(one.source(0));
    std::vector<double> resolutions = one.resolutions;
    if (options.resolution > 0.0) resolutions = {options.resolution};
    for (const double resolution : resolutions) {
      for (const bool discretize : {true, false}) {
        if (!discretize && !one.both_modes) continue;
        const Insertion how{one.name, resolution, one.max_range, discretize};
        const Inserted inserted = insert_all(options, one.source, how);
        if (table.rows.empty()) result.ours = median(inserted.ours), result.peer = median(inserted.peer);
        table.rows.push_back(inserted.row(how.name()));
        result.detail[how.name()] = inserted.json();
      }
    }
  }
  result.tables = {table, heap};
  result.compared = "Successive frames of a camera or turns of a lidar, each inserted once (" + extents +
                    "): `insert_scan` in compatible integration, whose tree is OctoMap's bit for bit, "
                    "against `insertPointCloud`. A "
                    "file with a single cloud goes into an empty map each time.";
  return result;
}

}  // namespace clearway::bench
