// A snapshot of the map: ours against OctoMap's copy; and a live map, with one writer and four readers.

#include <octomap/OcTree.h>

#include <algorithm>
#include <atomic>
#include <chrono>
#include <cmath>
#include <mutex>
#include <thread>

#include "apps/bench/bench.hpp"
#include "apps/bench/worlds/room_scans.hpp"
#include "mapping/free_space_map.hpp"
#include "mapping/latest_snapshot.hpp"

namespace clearway::bench {
namespace {

using Json = nlohmann::ordered_json;

void insert_stock(octomap::OcTree& tree, const Scan& scan) {
  octomap::Pointcloud cloud;
  for (const Eigen::Vector3f& point : scan.points) {
    const Eigen::Vector3f at = (scan.map_from_sensor * point.cast<double>()).cast<float>();
    cloud.push_back(at.x(), at.y(), at.z());
  }
  const Eigen::Vector3f origin = scan.map_from_sensor.translation().cast<float>();
  tree.insertPointCloud(cloud, {origin.x(), origin.y(), origin.z()}, -1.0, false, true);
}

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

Json figures(const std::vector<double>& values) {
  return {{"median", quantile(values, 0.5)},
          {"p99", quantile(values, 0.99)},
          {"p99.9", quantile(values, 0.999)},
          {"max", quantile(values, 1.0)}};
}

Json describe(const Live& live) {
  return {{"reader_wait_ms", figures(live.waits)},
          {"looks", live.waits.size()},
          {"ball_visible_ms", figures(live.visible)},
          {"paint_and_publish_ms", figures(live.paint)},
          {"insert_and_publish_ms", figures(live.insertion)}};
}

FreeSpaceMap painted_map(double resolution) {
  FreeSpaceMap map({.resolution = resolution, .discretize = true});
  map.add_volume("tunnel", {"tool"});
  return map;
}

}  // namespace

BenchResult bench_snapshot(const BenchOptions& options) {
  const double resolution = options.resolution > 0.0 ? options.resolution : 0.02;
  constexpr std::size_t frames = 24;
  const std::vector<Scan> scans = room_scans(frames);
  FreeSpaceMap map = painted_map(resolution);
  octomap::OcTree stock(resolution);
  for (std::size_t i = 0; i + 4 < frames; ++i) {
    map.insert(scans[i]);
    if (resolution >= 0.02) insert_stock(stock, scans[i]);
  }
  if (resolution < 0.02) insert_stock(stock, scans.front());
  const Pair pair = interleave(
      options.runs, [&] { return 1e3 * cpu_seconds([&] { static_cast<void>(map.snapshot()); }); },
      [&] { return 1e3 * cpu_seconds([&] { const octomap::OcTree copy(stock); }); });

  std::vector<double> alone, shared;
  for (int run = 0; run < options.runs; ++run) {
    const Scan& scan = scans[frames - 4 + static_cast<std::size_t>(run) % 4];
    alone.push_back(1e3 * cpu_seconds([&] { map.insert(scan); }));
    const Snapshot held = map.snapshot();
    shared.push_back(1e3 * cpu_seconds([&] { map.insert(scan); }));
  }
  Json detail{{"resolution", resolution},
              {"stock_nodes", stock.size()},
              {"insert_ms_nothing_shared", median(alone)},
              {"insert_ms_while_a_snapshot_is_held", median(shared)}};
  detail["live_scans_30hz"] = describe(run_live(map, scans, 30.0, 5.0));
  FreeSpaceMap fine = painted_map(0.005);
  detail["live_paint_5mm_voxels"] = describe(run_live(fine, {}, 0.0, 5.0));
  return {pair.ours,    pair.peer, "OctoMap copy constructor", "CPU ms per snapshot", true,
          options.runs, detail};
}

}  // namespace clearway::bench
