#include "mapping/continued_map.hpp"

#include <algorithm>
#include <cmath>
#include <stdexcept>

#include "mapping/map_option.hpp"
#include "mapping/scans/scan_rays.hpp"
#include "mapping/stamps/seen_stamps.hpp"
#include "mapping/voxels/fused_tree.hpp"

namespace clearway {

struct ContinuedMap::State {
  State(const Snapshot& start, const MapOptions& options)
      : tree(start.tree()), seen(start.seen() != nullptr ? *start.seen() : SeenStamps()), latest(start) {
    tree.setProbHit(options.hit_probability);
    tree.setProbMiss(options.miss_probability);
    insertion.discretize = options.discretize;
    insertion.threads = options.threads;
    insertion.integration = options.integration;
    insertion.margins = options.margins;
  }
  FusedTree tree;
  SeenStamps seen;
  ScanInsertion insertion;
  ScanWorkspace workspace;
  ScanEvidence evidence;
  Snapshot latest;
  bool is_changed = false;  ///< since `latest`
};

ContinuedMap::ContinuedMap(const Snapshot& start, const MapOptions& options) {
  check_insertion_options(options);
  state_ = std::make_unique<State>(start, options);
}
ContinuedMap::~ContinuedMap() = default;
ContinuedMap::ContinuedMap(ContinuedMap&&) noexcept = default;
ContinuedMap& ContinuedMap::operator=(ContinuedMap&&) noexcept = default;

ContinuedMap::State& ContinuedMap::state() const {
  if (!state_) throw std::logic_error("the map was moved elsewhere, expected one that was not moved from");
  return *state_;
}

ScanCounts ContinuedMap::insert(const Scan& scan, const ScanFilter& filter) {
  State& map = state();
  map.is_changed = true;
  const ScanCounts counts = insert_scan(map.tree, scan, filter, map.insertion, map.workspace, &map.evidence);
  if (!counts.origin_invalid) map.seen.see(map.workspace.grid, scan.time, map.insertion.threads);
  return counts;
}

const Snapshot& ContinuedMap::snapshot() {
  State& map = state();
  if (map.is_changed) {
    const std::vector<PaintedVolume> volumes = map.latest.volumes();
    map.latest = Snapshot(std::make_shared<const FusedTree>(map.tree), volumes, map.latest,
                          std::make_shared<const SeenStamps>(map.seen));
    map.is_changed = false;
  }
  return map.latest;
}

double decisive_hit_probability(const Snapshot& map, double least, int misses, double miss_probability) {
  double lowest = map.tree().getClampingThresMinLog();
  map.visit_leaves([&](const Voxel& leaf) {
    if (leaf.observed) lowest = std::min(lowest, leaf.log_odds);
  });
  const double threshold = map.tree().getOccupancyThresLog();
  const double a_miss = std::log((1.0 - miss_probability) / miss_probability);
  const double needed = threshold - lowest + misses * a_miss + 0.01;  // log-odds; floats round
  return std::clamp(1.0 / (1.0 + std::exp(-needed)), least, 0.999999);
}

}  // namespace clearway
