// What keeping scans costs: inserting with it against without, bytes a scan, a look-up; erasing and undoing.

#include "mapping/history/provenance.hpp"

#include "apps/bench/bench.hpp"
#include "apps/bench/worlds/room_scans.hpp"
#include "datasets/simulation/room.hpp"
#include "mapping/free_space_map.hpp"

namespace clearway::bench {
namespace {

/// A dense stroke of 1,000 spheres of 4 cm along 2 m.
void paint_stroke(FreeSpaceMap& map) {
  map.begin_stroke("stroke");
  for (int i = 0; i < 1000; ++i) map.paint(0, {{0.5 + 0.002 * i, 1.0, 1.0}, 0.04});
}

}  // namespace

BenchResult bench_provenance(const BenchOptions& options) {
  const double resolution = options.resolution > 0.0 ? options.resolution : 0.02;
  const FurnishedRoom room(static_cast<std::size_t>(options.runs), 1, 1.0);
  FreeSpaceMap keeping({.resolution = resolution}), plain({.resolution = resolution});
  keeping.keep_scans();
  std::size_t next_ours = 0, next_peer = 0;
  const auto insert = [&](FreeSpaceMap& map, std::size_t& next) {
    const Scan scan = scan_of(room.frame(next++));
    return 1e3 * cpu_seconds([&] { map.insert(scan); });
  };
  const Pair pair = interleave(
      options, [&] { return insert(keeping, next_ours); }, [&] { return insert(plain, next_peer); });

  const Provenance provenance = keeping.provenance();
  const double scans = static_cast<double>(provenance.scans.scans().size());
  const double look_up =
      cpu_seconds([&] { static_cast<void>(provenance.scans.touched(Eigen::Vector3i(25, 25, 25))); });
  const double file_bytes = static_cast<double>(format_provenance(provenance).size());

  keeping.add_volume("tunnel", {});
  const double paint = cpu_seconds([&] { paint_stroke(keeping); });
  std::vector<double> erasing;
  for (int i = 0; i < options.runs; ++i) {
    keeping.begin_stroke("eraser");
    erasing.push_back(1e3 * cpu_seconds([&] { keeping.erase(0, {{0.6 + 0.15 * i, 1.0, 1.0}, 0.04}); }));
  }
  const double undo = cpu_seconds([&] { keeping.undo_stroke(0); });
  const double bytes = static_cast<double>(provenance.scans.bytes()) / scans;
  BenchResult result{pair.ours,
                     pair.peer,
                     "inserting without keeping scans",
                     "CPU ms per scan",
                     true,
                     options.runs,
                     {{"resolution", resolution},
                      {"bytes_per_scan", bytes},
                      {"file_bytes", file_bytes},
                      {"look_up_ms_per_scan", 1e3 * look_up / scans},
                      {"paint_1000_balls_ms", 1e3 * paint},
                      {"erase_ms", median(erasing)},
                      {"undo_1000_balls_ms", 1e3 * undo}}};
  result.compared =
      "Frames of 640 × 480 pixels of the generated room at " + length_text(resolution) +
      ", one a run: inserting with `keep_scans` against inserting without. Below 1 the ratio is what "
      "keeping costs.";
  result.tables = {
      {"",
       {"what", "figure"},
       {{"inserting a scan, with / without", figure(pair.ours) + " / " + figure(pair.peer) + " ms"},
        {"memory of a scan", figure(1e-3 * bytes) + " kB"},
        {"which scans touched a voxel, per scan", figure(1e3 * look_up / scans) + " ms"},
        {"erasing one ball of 4 cm among 1,000", figure(median(erasing)) + " ms"},
        {"undoing all 1,000 (once)", figure(1e3 * undo) + " ms"}}}};
  return result;
}

}  // namespace clearway::bench
