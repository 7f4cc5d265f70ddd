// A snapshot of the map: ours against OctoMap's copy; and a live map, with one writer and four readers.

#include <octomap/OcTree.h>

#include <algorithm>
#include <atomic>
#include <chrono>
#include <cmath>
#include <memory>
#include <mutex>
#include <optional>
#include <thread>

#include "apps/bench/bench.hpp"
#include "apps/bench/worlds/room_scans.hpp"
#include "mapping/free_space_map.hpp"
#include "mapping/latest_snapshot.hpp"
#include "mapping/voxels/fused_tree.hpp"

namespace clearway::bench {
namespace {

using Json = nlohmann::ordered_json;

/// What one live run measured, milliseconds.
struct Live {
  std::vector<double> waits;      ///< of readers, for the latest snapshot
  std::vector<double> visible;    ///< from the begin of painting a sphere until a reader sees it
  std::vector<double> paint;      ///< painting and publishing one sphere
  std::vector<double> insertion;  ///< one scan
};

/// Paints spheres of r = 4 cm at 60 Hz for some seconds, inserts the scans at `scan_rate`, while four readers
/// ask for the latest snapshot and look into it.
Live run_live(FreeSpaceMap& map, const std::vector<Scan>& scans, double scan_rate, double seconds) {
  Live live;
  LatestSnapshot latest;
  std::vector<std::atomic<double>> painted_at(static_cast<std::size_t>(60.0 * seconds) + 1);
  std::atomic<bool> done = false;
  std::mutex guard;
  std::vector<std::thread> readers;
  for (int r = 0; r < 4; ++r) {
    readers.emplace_back([&] {
      Live seen;
      std::size_t known = 0;
      while (!done) {
        const double asked = wall_time();
        const auto snapshot = latest.get();
        const double now = wall_time();
        seen.waits.push_back(1e3 * (now - asked));
        if (!snapshot->volumes().empty()) {
          const auto& spheres = snapshot->volumes().front().spheres;
          for (; known < spheres.size(); ++known) seen.visible.push_back(1e3 * (now - painted_at[known]));
          if (!spheres.empty()) static_cast<void>(snapshot->state(spheres.back().center));
        }
        std::this_thread::sleep_for(std::chrono::microseconds(500));
      }
      const std::lock_guard lock(guard);
      live.waits.insert(live.waits.end(), seen.waits.begin(), seen.waits.end());
      live.visible.insert(live.visible.end(), seen.visible.begin(), seen.visible.end());
    });
  }
  const double begin = wall_time();
  std::size_t scan = 0;
  for (std::size_t sphere = 0; sphere + 1 < painted_at.size(); ++sphere) {
    const double due = begin + static_cast<double>(sphere) / 60.0;
    if (due > wall_time()) std::this_thread::sleep_for(std::chrono::duration<double>(due - wall_time()));
    const double start = wall_time();
    painted_at[sphere] = start;
    const double turn = 0.03 * static_cast<double>(sphere);
    map.paint(0, {{0.5 * std::cos(turn), 0.5 * std::sin(turn), 0.9 + 0.1 * std::sin(0.3 * turn)}, 0.04});
    latest.publish(map.snapshot());
    live.paint.push_back(1e3 * (wall_time() - start));
    if (scan_rate <= 0.0 || static_cast<double>(scan) > scan_rate * (wall_time() - begin)) continue;
    const double insert = wall_time();
    map.insert(scans[scan++ % scans.size()]);
    latest.publish(map.snapshot());
    live.insertion.push_back(1e3 * (wall_time() - insert));
  }
  done = true;
  for (std::thread& reader : readers) reader.join();
  return live;
}

Json quantiles(const std::vector<double>& values) {
  return {{"median", quantile(values, 0.5)},
          {"p99", quantile(values, 0.99)},
          {"p99.9", quantile(values, 0.999)},
          {"max", quantile(values, 1.0)}};
}

Json describe(const Live& live) {
  return {{"reader_wait_ms", quantiles(live.waits)},
          {"looks", live.waits.size()},
          {"ball_visible_ms", quantiles(live.visible)},
          {"paint_and_publish_ms", quantiles(live.paint)},
          {"insert_and_publish_ms", quantiles(live.insertion)}};
}

FreeSpaceMap painted_map(double resolution) {
  FreeSpaceMap map({.resolution = resolution, .discretize = true});
  map.add_volume("tunnel", {"tool"});
  return map;
}

/// The same nodes in an octomap::OcTree.
std::unique_ptr<octomap::OcTree> mirrored(const Snapshot& map) {
  auto stock = std::make_unique<MirrorTree<octomap::OcTree>>(map.resolution());
  stock->mirror(map.tree(),
                [](const FusedNode& from, octomap::OcTreeNode& to) { to.setLogOdds(from.getLogOdds()); });
  return stock;
}

/// CPU ms.
struct SnapshotMs {
  std::vector<double> ours, peer;           ///< taking it
  std::vector<double> alone, while_shared;  ///< inserting a scan: nothing shared, or a snapshot held

  /// What one snapshot costs ours: taking it, and copying the nodes that the next scan changes.
  double ours_in_all() const { return median(ours) + std::max(0.0, median(while_shared) - median(alone)); }
};

/// After each new scan a snapshot of ours, which gives back the one before, and a copy of OctoMap's tree,
/// which is given back.
SnapshotMs time_snapshots(const BenchOptions& options, FreeSpaceMap& map, const octomap::OcTree& stock,
                          const std::vector<Scan>& scans) {
  SnapshotMs times;
  const auto scan = [&](int number) {
    return scans[scans.size() - 4 + static_cast<std::size_t>(number) % 4];
  };
  for (int run = 0; run < options.runs; ++run) {
    options.say_run(run, options.runs);
    times.alone.push_back(1e3 * cpu_seconds([&, next = scan(run)] { map.insert(next); }));
    std::optional<Snapshot> held;
    times.ours.push_back(1e3 * cpu_seconds([&] { held.emplace(map.snapshot()); }));
    times.while_shared.push_back(1e3 * cpu_seconds([&, next = scan(run + 1)] { map.insert(next); }));
    settle_heap();
    times.peer.push_back(1e3 * cpu_seconds([&] { const octomap::OcTree copy(stock); }));
  }
  return times;
}

std::vector<std::string> live_row(const std::string& name, const std::vector<double>& ms) {
  return {name, figure(1e3 * quantile(ms, 0.5)), figure(1e3 * quantile(ms, 0.99)),
          figure(1e3 * quantile(ms, 1.0))};
}

Table live_table(const std::string& title, const Live& live) {
  Table table{title, {"wall us", "median", "p99", "most"}, {}};
  table.rows = {live_row("a reader waits for the latest snapshot", live.waits),
                live_row("a painted ball is visible to a reader", live.visible),
                live_row("painting a ball and publishing", live.paint)};
  if (!live.insertion.empty())
    table.rows.push_back(live_row("inserting a scan and publishing", live.insertion));
  return table;
}

}  // namespace

BenchResult bench_snapshot(const BenchOptions& options) {
  const double resolution = options.resolution > 0.0 ? options.resolution : 0.02;
  constexpr std::size_t frames = 24;
  constexpr double live_seconds = 5.0;
  const std::vector<Scan> scans = room_scans(frames);
  FreeSpaceMap map = painted_map(resolution);
  for (std::size_t i = 0; i + 4 < frames; ++i) map.insert(scans[i]);
  const std::unique_ptr<octomap::OcTree> stock = mirrored(map.snapshot());
  const SnapshotMs times = time_snapshots(options, map, *stock, scans);
  options.say("scans and painting beside readers");
  const Live live = run_live(map, scans, 30.0, live_seconds);
  options.say("painting at 5 mm beside readers");
  FreeSpaceMap fine = painted_map(0.005);
  const Live painting = run_live(fine, {}, 0.0, live_seconds);
  const double ours = times.ours_in_all(), peer = median(times.peer);
  BenchResult result{ours, peer, "OctoMap copy constructor", "CPU ms per snapshot", true, options.runs, {}};
  result.detail = {{"resolution", resolution},
                   {"stock_nodes", stock->size()},
                   {"snapshot_ms", median(times.ours)},
                   {"insert_ms_nothing_shared", median(times.alone)},
                   {"insert_ms_while_a_snapshot_is_held", median(times.while_shared)},
                   {"live_scans_30hz", describe(live)},
                   {"live_paint_5mm_voxels", describe(painting)}};
  result.compared =
      "A map of 20 frames of the generated room at " + length_text(resolution) + ", " +
      figure(1e-6 * static_cast<double>(stock->size())) +
      " million nodes: `snapshot` after each further frame against a copy of an `octomap::OcTree` of the "
      "same nodes. Ours shares nodes and pays when the next frame changes them; that counts. OctoMap's nodes "
      "lie in the order of copying here, as in no map that grew. Giving back counts on both sides.";
  result.tables = {
      {"",
       {"CPU ms", "ours", "OctoMap", "ratio"},
       {{"taking a snapshot and giving back the one before", figure(median(times.ours)), figure(peer), "–"},
        {"the next frame, with a snapshot held", figure(median(times.while_shared)), "–", "–"},
        {"a frame with nothing shared", figure(median(times.alone)), "–", "–"},
        {"a snapshot in all", figure(ours), figure(peer), figure(peer / ours)}}},
      live_table("640 × 480 frames at 30 Hz and balls of 4 cm at 60 Hz, beside four readers, 5 s:", live),
      live_table("Balls alone, at 5 mm, 5 s:", painting)};
  return result;
}

}  // namespace clearway::bench
