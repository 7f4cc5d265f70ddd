// Erosion: of the surface points of held-out scans, the share whose voxel the map calls free. Ours in `safe`
// integration against OctoMap. On generated frames also what that costs of the truly free space, and how many
// truly free voxels spurious returns block, for how many looks.

#include <octomap/OcTree.h>

#include <algorithm>

#include "apps/bench/bench.hpp"
#include "apps/bench/judges/ghosts.hpp"
#include "apps/bench/judges/held_out.hpp"
#include "apps/bench/judges/room_truth.hpp"
#include "apps/bench/worlds/ground_drive.hpp"
#include "apps/bench/worlds/noise_laws.hpp"
#include "apps/bench/worlds/scan_source.hpp"
#include "mapping/free_space_map.hpp"
#include "mapping/voxels/fused_tree.hpp"

namespace clearway::bench {
namespace {

using nlohmann::ordered_json;

struct ErosionCase {
  double resolution;
  bool discretize;
};

/// Shares of the held-out points that a map calls free.
struct CalledFree {
  double all = 0.0, grazing = 0.0;              ///< where they were measured
  double exact_all = 0.0, exact_grazing = 0.0;  ///< where the surface truly is; 0 when not known
  double before = 0.0;                          ///< 5 cm before it; 0 when not known

  ordered_json json(bool exact) const {
    ordered_json shares{{"all", all}, {"grazing", grazing}};
    if (exact) shares.update({{"exact_surface", exact_all}, {"exact_surface_grazing", exact_grazing}});
    if (before > 0.0) shares["free_5_cm_before"] = before;
    return shares;
  }
};

CalledFree called_free(const HeldOutSequence& sequence, const StateAt& state_at) {
  std::size_t count = 0, grazing = 0, free = 0, free_grazing = 0, exact = 0, exact_grazing = 0, before = 0;
  for (const HeldOutPoint& point : sequence.held_out) {
    const std::size_t is_free = state_at(point.measured) == VoxelState::seen_free ? 1 : 0;
    const std::size_t exact_free = point.exact && state_at(*point.exact) == VoxelState::seen_free ? 1 : 0;
    ++count;
    free += is_free;
    exact += exact_free;
    before += point.before && state_at(*point.before) == VoxelState::seen_free ? 1 : 0;
    if (!point.grazing) continue;
    ++grazing;
    free_grazing += is_free;
    exact_grazing += exact_free;
  }
  return {share(free, count), share(free_grazing, grazing), share(exact, count),
          share(exact_grazing, grazing), share(before, count)};
}

VoxelState stock_state(const octomap::OcTree& tree, const Eigen::Vector3d& point) {
  const octomap::OcTreeNode* node = tree.search(point.x(), point.y(), point.z());
  if (node == nullptr) return VoxelState::unknown;
  return tree.isNodeOccupied(node) ? VoxelState::occupied : VoxelState::seen_free;
}

/// One resolution: both maps of the same scans, insertion interleaved.
struct ErosionOutcome {
  CalledFree ours, peer;
  ordered_json json;
};

ErosionOutcome evaluate(const HeldOutSequence& sequence, const FurnishedRoom* room,
                        const ErosionCase& which) {
  MapOptions options{.resolution = which.resolution, .discretize = which.discretize};
  options.integration = Integration::safe;
  FreeSpaceMap safe(options);
  options.integration = Integration::compatible;
  FreeSpaceMap compatible(options);
  const ScanFilter filter{.max_range = sequence.max_range};
  std::vector<double> safe_ms, compatible_ms;
  for (const Scan& scan : sequence.scans) {
    safe_ms.push_back(1e3 * cpu_seconds([&] { safe.insert(scan, filter); }));
    compatible_ms.push_back(1e3 * cpu_seconds([&] { compatible.insert(scan, filter); }));
  }
  const Snapshot ours = safe.snapshot(), peer = compatible.snapshot();
  const StateAt our_state = [&](const Eigen::Vector3d& point) { return ours.state(point); };
  const StateAt peer_state = [&](const Eigen::Vector3d& point) { return peer.state(point); };
  ErosionOutcome outcome{called_free(sequence, our_state), called_free(sequence, peer_state), {}};
  outcome.json = {{"resolution", which.resolution},
                  {"discretize", which.discretize},
                  {"ours", outcome.ours.json(room != nullptr)},
                  {"peer", outcome.peer.json(room != nullptr)},
                  {"cpu_ms_per_scan", {{"safe", median(safe_ms)}, {"compatible", median(compatible_ms)}}},
                  {"cpu_ratio", median(safe_ms) / median(compatible_ms)}};
  const ScanAgreement& agreement = ours.tree().agreement();
  outcome.json["reported_by_map"] = agreement.share_called_free();
  if (room != nullptr)
    outcome.json["truth"] = compare_with_truth(*room, which.resolution, our_state, peer_state);
  return outcome;
}

/// The compatible map stands in for OctoMap, being its tree bit for bit (tests/mapping/scans/scan_rays_test);
/// here two scans are checked against OctoMap itself: the same answer at every held-out point.
bool stands_in_for_octomap(const HeldOutSequence& sequence, double resolution) {
  octomap::OcTree stock(resolution);
  FreeSpaceMap map({.resolution = resolution, .discretize = true, .integration = Integration::compatible});
  for (std::size_t i = 0; i < std::min<std::size_t>(2, sequence.scans.size()); ++i) {
    insert_stock(stock, sequence.scans[i], sequence.max_range, true);
    map.insert(sequence.scans[i], {.max_range = sequence.max_range});
  }
  const Snapshot snapshot = map.snapshot();
  return std::all_of(sequence.held_out.begin(), sequence.held_out.end(), [&](const HeldOutPoint& point) {
    return snapshot.state(point.measured) == stock_state(stock, point.measured);
  });
}

/// One sequence of scans, judged in one or more cases: rows of the table.
class ErosionTable {
 public:
  void add(const std::string& noise, const HeldOutSequence& sequence, const FurnishedRoom* room,
           const std::vector<ErosionCase>& cases, BenchResult& result) {
    ordered_json list = ordered_json::array();
    const auto reported = [&](double share) { return room == nullptr ? "–" : percent(share); };
    for (const ErosionCase& which : cases) {
      const ErosionOutcome outcome = evaluate(sequence, room, which);
      if (table_.rows.empty()) result.ours = outcome.ours.all, result.peer = outcome.peer.all;
      table_.rows.push_back(
          {noise, length_text(which.resolution), percent(outcome.ours.all), percent(outcome.peer.all),
           figure(outcome.peer.all / outcome.ours.all), reported(outcome.ours.exact_all),
           reported(outcome.peer.exact_all),
           room == nullptr ? "–" : percent(outcome.json["truth"]["truly_free_kept"].get<double>())});
      list.push_back(outcome.json);
    }
    result.detail[noise] = {{"source", sequence.source},
                            {"scans", sequence.scans.size()},
                            {"held_out_points", sequence.held_out.size()},
                            {"max_range", sequence.max_range},
                            {"cases", list}};
  }
  const Table& table() const { return table_; }

 private:
  Table table_{
      "Share of held-out points that the map calls free, where they were measured and where the surface "
      "truly is:",
      {"noise of the scene", "voxels", "ours", "OctoMap", "ratio", "true surface, ours",
       "true surface, OctoMap", "of OctoMap's truly free voxels, ours keeps"},
      {}};
};

std::vector<ErosionCase> cases_at(double asked, std::vector<double> usual) {
  if (asked > 0.0) return {{asked, true}, {asked, false}};
  std::vector<ErosionCase> cases;
  for (const double resolution : usual) cases.push_back({resolution, true});
  return cases;
}

/// The same walk with each law's noise; the assumed law also with exact poses.
void judge_laws(const BenchOptions& options, const std::vector<NoiseLaw>& laws, ErosionTable& table,
                BenchResult& result) {
  constexpr std::size_t round = 40;
  const std::size_t used = std::min(round, 4 * static_cast<std::size_t>(options.runs));
  for (const NoiseLaw& law : laws) {
    options.say(law.name);
    const FurnishedRoom room(round, 7, law.errors);
    std::vector<CloudFrame> frames;
    for (std::size_t i = 0; i < used; ++i) {
      frames.push_back(room.frame(i));
      disturb(law, i, frames.back());
    }
    const bool is_first = &law == &laws.front();
    const bool is_fine = is_first || law.is_time_of_flight;
    const HeldOutSequence sequence = hold_out(room, frames, false);
    table.add(law.name, sequence, &room,
              cases_at(options.resolution, is_fine ? std::vector{0.02, 0.01} : std::vector{0.02}), result);
    if (!is_first) continue;
    result.detail["same_as_octomap_2cm_2_scans"] = stands_in_for_octomap(sequence, 0.02);
    table.add(law.name + ", exact poses", hold_out(room, frames, true), &room,
              cases_at(options.resolution, {0.02}), result);
  }
}

/// Sequences of many views with errors that the map does not know, longer with more runs.
Table judge_wide(const BenchOptions& options, BenchResult& result) {
  Table table{
      "Views from all sides, every other frame held out; calibration, clocks, ranges and poses are wrong in "
      "ways that the map does not know. Where the surface truly is, called free; free 5 cm before it:",
      {"sensor", "voxels", "ours", "OctoMap", "slanted > 60°, ours", "OctoMap", "5 cm before, ours",
       "OctoMap", "of OctoMap's truly free voxels, ours keeps", "by the map's own account"},
      {}};
  const std::size_t frames = 32 * static_cast<std::size_t>(options.runs) / 3;
  struct Sensor {
    const char* family;
    std::uint64_t seed;
    std::vector<double> resolutions;
  };
  const std::vector<Sensor> sensors{{"kinect", 8, {0.02, 0.01}},
                                    {"stereo", 5, {0.02}},
                                    {"time_of_flight", 4, {0.02}},
                                    {"lidar", 6, {0.02}}};
  for (const Sensor& sensor : sensors) {
    options.say(sensor.family);
    const DrawnErrors drawn = draw_errors(sensor.family, sensor.seed);
    const FurnishedRoom room(frames, sensor.seed, {drawn.noise, drawn.errors}, RoomWalk::wide);
    const HeldOutSequence sequence = hold_out_wide(room);
    ordered_json cases = ordered_json::array();
    for (const ErosionCase& which : cases_at(options.resolution, sensor.resolutions)) {
      const ErosionOutcome outcome = evaluate(sequence, &room, which);
      table.rows.push_back({sensor.family, length_text(which.resolution), percent(outcome.ours.exact_all),
                            percent(outcome.peer.exact_all), percent(outcome.ours.exact_grazing),
                            percent(outcome.peer.exact_grazing), percent(outcome.ours.before),
                            percent(outcome.peer.before),
                            percent(outcome.json["truth"]["truly_free_kept"].get<double>()),
                            percent(outcome.json["reported_by_map"].get<double>())});
      cases.push_back(outcome.json);
    }
    result.detail["wide views"][sensor.family] = {{"seed", sensor.seed},
                                                  {"scans", sequence.scans.size()},
                                                  {"held_out_points", sequence.held_out.size()},
                                                  {"cases", cases}};
  }
  return table;
}

/// Drives with lidars whose rings lie farther apart on the ground than a voxel is wide.
Table judge_drives(const BenchOptions& options, BenchResult& result) {
  Table table{
      "Drives over uneven ground; ranges err by 2 cm, poses by 1 cm and 0.05°. Where the rays of other scans "
      "truly met "
      "something, called free; two and a half voxels over the ground, 5 m beside the way at most, free:",
      {"lidar", "voxels", "ground, ours", "OctoMap", "boxes and posts, ours", "OctoMap",
       "over the ground, ours", "OctoMap", "CPU ms per scan, ours", "OctoMap's rules"},
      {}};
  struct Case {
    DrivenLidar lidar;
    double resolution;
  };
  const std::vector<Case> cases{{{"64 rings at 1.73 m", 64, 2.0, -24.8, 700, 1.73}, 0.2},
                                {{"16 rings at 0.6 m", 16, 15.0, -15.0, 900, 0.6}, 0.1}};
  for (const auto& [lidar, usual] : cases) {
    options.say(lidar.name);
    const double resolution = options.resolution > 0.0 ? options.resolution : usual;
    const GroundDrive driven = drive(lidar, 100, 11);
    MapOptions map{.resolution = resolution};
    FreeSpaceMap safe(map);
    map.integration = Integration::compatible;
    FreeSpaceMap compatible(map);
    std::vector<double> safe_ms, compatible_ms;
    for (const Scan& scan : driven.scans) {
      safe_ms.push_back(1e3 * cpu_seconds([&] { safe.insert(scan, {}); }));
      compatible_ms.push_back(1e3 * cpu_seconds([&] { compatible.insert(scan, {}); }));
    }
    const std::vector<Eigen::Vector3d> above = driven.above(2.5 * resolution, 20000);
    const Snapshot ours = safe.snapshot(), peer = compatible.snapshot();
    std::vector<std::string> row{lidar.name, length_text(resolution)};
    ordered_json& shares = result.detail["drives"][lidar.name];
    for (const auto& [what, points] :
         {std::pair{"ground", &driven.ground}, {"standing", &driven.standing}, {"above", &above}}) {
      for (const auto& [whose, snapshot] : {std::pair{"ours", &ours}, {"peer", &peer}}) {
        const auto free = std::count_if(points->begin(), points->end(), [&](const Eigen::Vector3d& point) {
          return snapshot->state(point) == VoxelState::seen_free;
        });
        shares[what][whose] = share(static_cast<std::size_t>(free), points->size());
        row.push_back(percent(shares[what][whose].get<double>()));
      }
    }
    shares["cpu_ms_per_scan"] = {{"safe", median(safe_ms)}, {"compatible", median(compatible_ms)}};
    row.push_back(figure(median(safe_ms)));
    row.push_back(figure(median(compatible_ms)));
    table.rows.push_back(std::move(row));
  }
  return table;
}

Table ghost_table(const ordered_json& ghosts) {
  Table table{"Stray returns that block free space, ten looks from one place:",
              {"noise of the scene", "voxels", "per million rays", "looks until free, median", "at most",
               "left at the end"},
              {}};
  for (const ordered_json& of_law : ghosts) {
    for (const char* where : {"all", "in_the_open"}) {
      const ordered_json& reported = of_law[where];
      const ordered_json& looks = reported["looks_until_free"];
      const auto look = [&](const char* key) {
        return looks.is_null() ? std::string("–") : count_text(looks[key].get<double>());
      };
      table.rows.push_back({of_law["noise"].get<std::string>(),
                            where == std::string("all") ? "all" : "farther than two bands from solids",
                            count_text(reported["per_million_rays"].get<double>()), look("median"),
                            look("most"), count_text(reported["left_at_the_end"].get<double>())});
    }
  }
  return table;
}

}  // namespace

BenchResult bench_erosion(const BenchOptions& options) {
  BenchResult result;
  result.peer_name = "OctoMap (its tree bit for bit)";
  result.unit = "share of surface points called free";
  result.runs = options.runs;
  ErosionTable table;
  if (!options.input.empty()) {
    const std::size_t frames = 20 * static_cast<std::size_t>(options.runs);
    table.add("as recorded", hold_out(options.input, frames), nullptr,
              cases_at(options.resolution, {0.02, 0.01, 0.05}), result);
    result.compared = "Every other cloud of a recording, judged at the surface points of the others.";
    result.tables = {table.table()};
    return result;
  }
  const std::vector<NoiseLaw> laws = noise_laws(0.006, 0.0035);
  judge_laws(options, laws, table, result);
  const Table wide = judge_wide(options, result);
  const Table drives = judge_drives(options, result);
  options.say("stray returns");
  const double resolution = options.resolution > 0.0 ? options.resolution : 0.02;
  for (const NoiseLaw& law : laws) result.detail["ghosts"].push_back(watch_ghosts(law, resolution));
  result.compared =
      "Depth frames of the generated room, every other one held out, with errors of the poses (6 mm and 0.2° "
      "per axis): "
      "a map in safe integration against OctoMap's, discretized. Safe integration assumes sigma = 1.2 mm + "
      "1.9 mm/m² r²; "
      "the first row's scene obeys it, the others do not: half, twice, and two laws of another kind.";
  result.tables = {table.table(), wide, drives, ghost_table(result.detail["ghosts"])};
  return result;
}

}  // namespace clearway::bench
