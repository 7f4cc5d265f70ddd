// Erosion: of the surface points of held-out scans, the share whose voxel the map calls free. Ours in `safe`
// integration against OctoMap. On generated frames also what that costs of the truly free space, and how many
// truly free voxels spurious returns block, for how many looks.

#include <octomap/OcTree.h>

#include <random>

#include "apps/bench/bench.hpp"
#include "apps/bench/ghosts.hpp"
#include "apps/bench/held_out.hpp"
#include "mapping/free_space_map.hpp"

namespace clearway::bench {
namespace {

using nlohmann::ordered_json;
using StateAt = std::function<VoxelState(const Eigen::Vector3d&)>;

struct Case {
  double resolution;
  bool discretize;
};

double share(std::size_t part, std::size_t whole) {
  return whole == 0 ? 0.0 : static_cast<double>(part) / static_cast<double>(whole);
}

/// Shares of the held-out points that a map calls free.
struct CalledFree {
  double all = 0.0, grazing = 0.0;              ///< where they were measured
  double exact_all = 0.0, exact_grazing = 0.0;  ///< where the surface truly is; 0 when not known

  ordered_json json(bool exact) const {
    ordered_json shares{{"all", all}, {"grazing", grazing}};
    if (exact) shares.update({{"exact_surface", exact_all}, {"exact_surface_grazing", exact_grazing}});
    return shares;
  }
};

CalledFree called_free(const HeldOutSequence& sequence, const StateAt& state_at) {
  std::size_t count = 0, grazing = 0, free = 0, free_grazing = 0, exact = 0, exact_grazing = 0;
  for (const HeldOutPoint& point : sequence.held_out) {
    const std::size_t is_free = state_at(point.measured) == VoxelState::seen_free ? 1 : 0;
    const std::size_t exact_free = point.exact && state_at(*point.exact) == VoxelState::seen_free ? 1 : 0;
    ++count;
    free += is_free;
    exact += exact_free;
    if (!point.grazing) continue;
    ++grazing;
    free_grazing += is_free;
    exact_grazing += exact_free;
  }
  return {share(free, count), share(free_grazing, grazing), share(exact, count),
          share(exact_grazing, grazing)};
}

/// True when no solid comes into the cube, up to cubes of an eighth of the edge.
bool is_truly_free(const FurnishedRoom& room, const Eigen::Vector3d& center, double half, int depth = 3) {
  const double distance = room.distance_to_solid(center);
  if (distance >= half * std::sqrt(3.0)) return true;
  if (distance <= half || depth == 0) return false;
  for (int corner = 0; corner < 8; ++corner) {
    const Eigen::Vector3d side(corner & 1 ? 1 : -1, corner & 2 ? 1 : -1, corner & 4 ? 1 : -1);
    if (!is_truly_free(room, center + 0.5 * half * side, 0.5 * half, depth - 1)) return false;
  }
  return true;
}

/// Ours against the compatible map (OctoMap's) and the truth, on random voxels of the room.
ordered_json compare_with_truth(const FurnishedRoom& room, double resolution, const StateAt& ours,
                                const StateAt& peer) {
  std::mt19937 engine(1);
  const auto uniform = [&](double low, double high) {
    return std::uniform_real_distribution<double>(low, high)(engine);
  };
  struct Tally {
    std::size_t both = 0, truly_free = 0, inside = 0, touched = 0;
    std::size_t wrong_inside[2]{}, wrong_touched[2]{}, phantom[2]{}, free[2]{};
  } tally;
  for (int i = 0; i < 300'000; ++i) {
    const Eigen::Vector3d point(uniform(-3.2, 3.2), uniform(-2.8, 2.8), uniform(-0.2, 2.9));
    const Eigen::Vector3d center = ((point / resolution).array().floor() + 0.5) * resolution;
    const VoxelState states[2] = {ours(center), peer(center)};
    const double distance = room.distance_to_solid(center);
    const bool truly_free = is_truly_free(room, center, 0.5 * resolution);
    const bool inside = distance <= -0.5 * std::sqrt(3.0) * resolution;
    const bool free[2] = {states[0] == VoxelState::seen_free, states[1] == VoxelState::seen_free};
    tally.truly_free += truly_free;
    tally.inside += inside;
    tally.touched += !truly_free && !inside;
    for (int map = 0; map < 2; ++map) {
      tally.free[map] += truly_free && free[map];
      tally.phantom[map] += truly_free && states[map] == VoxelState::occupied;
      tally.wrong_inside[map] += inside && free[map];
      tally.wrong_touched[map] += !truly_free && !inside && free[map];
    }
    tally.both += truly_free && free[0] && free[1];
  }
  const auto side = [&](int map) {
    return ordered_json{{"inside_obstacles_freed", share(tally.wrong_inside[map], tally.inside)},
                        {"surface_voxels_freed", share(tally.wrong_touched[map], tally.touched)},
                        {"free_voxels_occupied", share(tally.phantom[map], tally.truly_free)}};
  };
  return {{"truly_free_kept", share(tally.both, tally.free[1])}, {"ours", side(0)}, {"peer", side(1)}};
}

void insert_stock(octomap::OcTree& tree, const Scan& scan, double max_range, bool discretize) {
  octomap::Pointcloud cloud;
  for (const Eigen::Vector3f& point : scan.points) {
    const Eigen::Vector3f at = (scan.map_from_sensor * point.cast<double>()).cast<float>();
    cloud.push_back(at.x(), at.y(), at.z());
  }
  const Eigen::Vector3f origin = scan.map_from_sensor.translation().cast<float>();
  tree.insertPointCloud(cloud, {origin.x(), origin.y(), origin.z()}, max_range > 0.0 ? max_range : -1.0,
                        false, discretize);
}

VoxelState stock_state(const octomap::OcTree& tree, const Eigen::Vector3d& point) {
  const octomap::OcTreeNode* node = tree.search(point.x(), point.y(), point.z());
  if (node == nullptr) return VoxelState::unknown;
  return tree.isNodeOccupied(node) ? VoxelState::occupied : VoxelState::seen_free;
}

/// One resolution: both maps of the same scans, insertion interleaved.
struct Outcome {
  CalledFree ours, peer;
  ordered_json json;
};

Outcome evaluate(const HeldOutSequence& sequence, const FurnishedRoom* room, const Case& which) {
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
  Outcome outcome{called_free(sequence, our_state), called_free(sequence, peer_state), {}};
  outcome.json = {{"resolution", which.resolution},
                  {"discretize", which.discretize},
                  {"ours", outcome.ours.json(room != nullptr)},
                  {"peer", outcome.peer.json(room != nullptr)},
                  {"cpu_ms_per_scan", {{"safe", median(safe_ms)}, {"compatible", median(compatible_ms)}}},
                  {"cpu_ratio", median(safe_ms) / median(compatible_ms)}};
  if (room != nullptr)
    outcome.json["truth"] = compare_with_truth(*room, which.resolution, our_state, peer_state);
  return outcome;
}

/// The compatible map stands in for OctoMap, being its tree bit for bit (tests/mapping/scans/scan_rays_test);
/// here a few scans are checked against OctoMap itself: the same answer at every held-out point.
bool stands_in_for_octomap(const HeldOutSequence& sequence, double resolution) {
  octomap::OcTree stock(resolution);
  FreeSpaceMap map({.resolution = resolution, .discretize = true, .integration = Integration::compatible});
  for (std::size_t i = 0; i < std::min<std::size_t>(4, sequence.scans.size()); ++i) {
    insert_stock(stock, sequence.scans[i], sequence.max_range, true);
    map.insert(sequence.scans[i], {.max_range = sequence.max_range});
  }
  const Snapshot snapshot = map.snapshot();
  return std::all_of(sequence.held_out.begin(), sequence.held_out.end(), [&](const HeldOutPoint& point) {
    return snapshot.state(point.measured) == stock_state(stock, point.measured);
  });
}

std::vector<Case> cases(double resolution) {
  if (resolution > 0.0) return {{resolution, true}, {resolution, false}};
  return {{0.02, true}, {0.02, false}, {0.01, true}, {0.01, false}, {0.05, true}};
}

ordered_json evaluate_all(const HeldOutSequence& sequence, const FurnishedRoom* room, double resolution,
                          BenchResult& result) {
  ordered_json list = ordered_json::array();
  for (const Case& which : cases(resolution)) {
    const Outcome outcome = evaluate(sequence, room, which);
    if (list.empty()) {
      result.ours = outcome.ours.all;
      result.peer = outcome.peer.all;
    }
    list.push_back(outcome.json);
  }
  return {{"source", sequence.source},
          {"scans", sequence.scans.size()},
          {"held_out_points", sequence.held_out.size()},
          {"max_range", sequence.max_range},
          {"same_as_octomap_2cm_4_scans", stands_in_for_octomap(sequence, 0.02)},
          {"cases", list}};
}

}  // namespace

BenchResult bench_erosion(const BenchOptions& options) {
  BenchResult result;
  result.peer_name = "OctoMap (compatible integration, its tree bit for bit)";
  result.unit = "share of held-out surface points called free";
  result.runs = options.runs;
  if (!options.input.empty()) {
    const std::size_t frames = 20 * static_cast<std::size_t>(options.runs);
    result.detail = evaluate_all(hold_out(options.input, frames), nullptr, options.resolution, result);
    return result;
  }
  RoomErrors errors;
  errors.pose_shift = 0.006;
  errors.pose_turn = 0.0035;
  const FurnishedRoom room(4 * static_cast<std::size_t>(options.runs), 7, errors);
  std::vector<CloudFrame> frames;
  for (std::size_t i = 0; i < room.frames(); ++i) frames.push_back(room.frame(i));
  for (const double resolution : {0.02, 0.01}) {
    if (options.resolution > 0.0 && options.resolution != resolution) continue;
    result.detail["ghosts"].push_back(watch_ghosts(RoomErrors{}, resolution));
    result.detail["ghosts"].push_back(watch_ghosts(errors, resolution));
  }
  BenchResult exact;
  result.detail["exact_poses"] = evaluate_all(hold_out(room, frames, true), &room, options.resolution, exact);
  result.detail["pose_errors_6mm_0.2deg_an_axis"] =
      evaluate_all(hold_out(room, frames, false), &room, options.resolution, result);
  return result;
}

}  // namespace clearway::bench
