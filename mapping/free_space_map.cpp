#include "mapping/free_space_map.hpp"

#include <algorithm>
#include <cmath>
#include <stdexcept>

#include "mapping/fused_tree.hpp"
#include "mapping/painted_csv.hpp"
#include "mapping/scan_rays.hpp"

namespace clearway {
namespace {

void check_range(const char* name, double value, double low, double high) {
  if (value >= low && value <= high) return;  // false for NaN
  throw std::invalid_argument(std::string("map option ") + name + " is " + std::to_string(value) +
                              ", expected a value in [" + std::to_string(low) + ", " + std::to_string(high) +
                              "]");
}

void check_options(const MapOptions& options) {
  check_range("resolution", options.resolution, 1e-4, 100.0);
  check_range("hit_probability", options.hit_probability, 0.5, 0.999999);
  check_range("miss_probability", options.miss_probability, 1e-6, 0.5);
  check_range("min_probability", options.min_probability, 1e-6, 0.49);
  check_range("max_probability", options.max_probability, 0.51, 0.999999);
  check_range("threads", options.threads, 1, 64);
  check_range("margins.band", options.margins.band, 0.0, 100.0);
  check_range("margins.sigmas", options.margins.sigmas, 0.0, 100.0);
  check_range("margins.noise_constant", options.margins.noise_constant, 0.0, 100.0);
  check_range("margins.noise_quadratic", options.margins.noise_quadratic, 0.0, 100.0);
  check_range("margins.noise_limit", options.margins.noise_limit, 0.0, 100.0);
  check_range("occupied_probability", options.occupied_probability, options.min_probability,
              options.max_probability);
}

}  // namespace

struct FreeSpaceMap::State {
  explicit State(const MapOptions& chosen) : options(chosen), tree(chosen.resolution) {
    tree.setProbHit(options.hit_probability);
    tree.setProbMiss(options.miss_probability);
    tree.setClampingThresMin(options.min_probability);
    tree.setClampingThresMax(options.max_probability);
    tree.setOccupancyThres(options.occupied_probability);
  }
  MapOptions options;
  FusedTree tree;
  ScanWorkspace workspace;
  std::vector<PaintedVolume> volumes;
};

FreeSpaceMap::FreeSpaceMap(const MapOptions& options) {
  check_options(options);
  state_ = std::make_unique<State>(options);
}
FreeSpaceMap::~FreeSpaceMap() = default;
FreeSpaceMap::FreeSpaceMap(FreeSpaceMap&&) noexcept = default;
FreeSpaceMap& FreeSpaceMap::operator=(FreeSpaceMap&&) noexcept = default;

int FreeSpaceMap::add_volume(const std::string& label, const std::vector<std::string>& critical_parts) {
  auto& volumes = state_->volumes;
  const bool known =
      std::any_of(volumes.begin(), volumes.end(), [&](const auto& v) { return v.label == label; });
  if (known)
    throw std::invalid_argument("painted volume '" + label + "' exists already, expected a new label");
  if (volumes.size() >= static_cast<std::size_t>(FusedTree::volume_limit)) {
    throw std::invalid_argument("painted volume '" + label +
                                "' would be one too many, at most 15 are possible");
  }
  if (!is_storable_name(label) ||
      !std::all_of(critical_parts.begin(), critical_parts.end(), is_storable_name)) {
    throw std::invalid_argument("painted volume '" + label +
                                "': expected a label and part names without control characters");
  }
  volumes.push_back({label, critical_parts, {}, {}});
  return static_cast<int>(volumes.size()) - 1;
}

PaintCounts FreeSpaceMap::paint(int volume, const Sphere& ball, double time) {
  if (volume < 0 || volume >= static_cast<int>(state_->volumes.size())) {
    throw std::invalid_argument("painted volume " + std::to_string(volume) + " does not exist, " +
                                std::to_string(state_->volumes.size()) + " were added");
  }
  if (!ball.center.allFinite() || !std::isfinite(ball.radius) || !(ball.radius > 0.0) ||
      !std::isfinite(time)) {
    throw std::invalid_argument("painted ball: expected a finite centre and time and a radius > 0 in metres");
  }
  const PaintTally tally = state_->tree.paint(volume, ball);
  PaintedVolume& painted = state_->volumes[static_cast<std::size_t>(volume)];
  painted.balls.push_back(ball);
  painted.times.push_back(time);
  return {tally.painted, tally.newly, tally.conflicts};
}

ScanCounts FreeSpaceMap::insert(const Scan& scan, const ScanFilter& filter) {
  const MapOptions& options = state_->options;
  ScanInsertion insertion{.discretize = options.discretize, .threads = options.threads};
  insertion.integration = options.integration;
  insertion.margins = options.margins;
  return insert_scan(state_->tree, scan, filter, insertion, state_->workspace);
}

const MapOptions& FreeSpaceMap::options() const { return state_->options; }
const std::vector<PaintedVolume>& FreeSpaceMap::volumes() const { return state_->volumes; }

Snapshot FreeSpaceMap::snapshot() const {
  return {std::make_shared<const FusedTree>(state_->tree), state_->volumes};
}

}  // namespace clearway
