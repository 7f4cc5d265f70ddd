#include "mapping/free_space_map.hpp"

#include <algorithm>
#include <cmath>
#include <optional>
#include <stdexcept>

#include "mapping/map_option.hpp"
#include "mapping/scans/scan_rays.hpp"
#include "mapping/stamps/seen_stamps.hpp"
#include "mapping/system/plain_text.hpp"
#include "mapping/voxels/fused_tree.hpp"

namespace clearway {
namespace {

void check_options(const MapOptions& options) {
  check_map_option("resolution", options.resolution, 1e-4, 100.0);
  check_insertion_options(options);
  check_map_option("min_probability", options.min_probability, 1e-6, 0.49);
  check_map_option("max_probability", options.max_probability, 0.51, 0.999999);
  check_map_option("occupied_probability", options.occupied_probability, options.min_probability,
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
  void check_sphere(int volume, const Sphere& sphere, double time) const;
  RepaintTally repaint(const PaintLog::Change& change);

  MapOptions options;
  FusedTree tree;
  ScanWorkspace workspace;
  ScanEvidence evidence;
  SeenStamps seen;
  std::shared_ptr<const SeenStamps> seen_shared;  ///< by the snapshots since the last scan
  std::optional<Snapshot> last;                   ///< the next one takes over its blocked spaces
  PaintLog paint;
  ConflictWatch conflicts;
  std::optional<ScanLog> scans;
  int scans_inserted = 0;
};

void FreeSpaceMap::State::check_sphere(int volume, const Sphere& sphere, double time) const {
  const std::size_t volumes = paint.volumes().size();
  if (volume < 0 || volume >= static_cast<int>(volumes)) {
    throw std::invalid_argument("painted volume " + std::to_string(volume) + " does not exist, " +
                                std::to_string(volumes) + " were added");
  }
  require_sphere(sphere, time);
}

/// Lets the voxels agree with the spheres again.
RepaintTally FreeSpaceMap::State::repaint(const PaintLog::Change& change) {
  const PaintedVolume& volume = paint.volumes()[static_cast<std::size_t>(change.volume)];
  const RepaintTally tally = tree.repaint(change.volume, change.spheres, volume.spheres);
  conflicts.repainted(tree);
  return tally;
}

FreeSpaceMap::FreeSpaceMap(const MapOptions& options) {
  check_options(options);
  state_ = std::make_unique<State>(options);
}
FreeSpaceMap::~FreeSpaceMap() = default;
FreeSpaceMap::FreeSpaceMap(FreeSpaceMap&&) noexcept = default;
FreeSpaceMap& FreeSpaceMap::operator=(FreeSpaceMap&&) noexcept = default;

FreeSpaceMap::State& FreeSpaceMap::state() const {
  if (!state_) throw std::logic_error("the map was moved elsewhere, expected one that was not moved from");
  return *state_;
}

int FreeSpaceMap::add_volume(const std::string& label, const std::vector<std::string>& critical_parts) {
  const auto& volumes = state().paint.volumes();
  const bool known =
      std::any_of(volumes.begin(), volumes.end(), [&](const auto& v) { return v.label == label; });
  if (known)
    throw std::invalid_argument("painted volume " + quote(label) + " exists already, expected a new label");
  if (volumes.size() >= static_cast<std::size_t>(FusedTree::volume_limit)) {
    throw std::invalid_argument("painted volume " + quote(label) +
                                " would be one too many, at most 15 are possible");
  }
  require_storable(label, critical_parts);
  return state().paint.add_volume(label, critical_parts);
}

bool FreeSpaceMap::remove_last_volume() {
  if (!state().paint.remove_last_volume()) return false;
  state().conflicts.forget(static_cast<int>(state().paint.volumes().size()));
  return true;
}

PaintCounts FreeSpaceMap::paint(int volume, const Sphere& sphere, double time) {
  state().check_sphere(volume, sphere, time);
  require_paintable(sphere, time, state().options.resolution);
  state().paint.paint(volume, sphere,
                      time);  // first: where memory ends, no voxel is painted without its ball
  const PaintTally tally = state().tree.paint(volume, sphere);
  state().conflicts.painted(sphere, state().options.resolution, tally.new_conflicts, time,
                            state().paint.open_stroke(), volume);
  return {tally.painted, tally.newly, tally.conflicts};
}

EraseCounts FreeSpaceMap::erase(int volume, const Sphere& eraser, double time) {
  state().check_sphere(volume, eraser, time);
  const PaintLog::Change change = state().paint.erase(volume, eraser, time);
  const std::size_t unpainted = state().repaint(change).unpainted;
  return {change.shrunk, change.removed, unpainted};
}

int FreeSpaceMap::begin_stroke(const std::string& label, const std::string& source) {
  if (!is_storable_name(label) || !is_storable_name(source)) {
    throw std::invalid_argument("stroke " + quote(label) + ": expected names without control characters");
  }
  return state().paint.begin_stroke(label, source);
}

void FreeSpaceMap::end_stroke() { state().paint.end_stroke(); }

int FreeSpaceMap::undo_stroke() {
  const int last = state().paint.last_stroke();
  if (last >= 0) return undo_stroke(last);
  end_stroke();
  return -1;
}

int FreeSpaceMap::undo_stroke(int stroke) {
  const std::size_t strokes = state().paint.strokes().size();
  if (stroke < 0 || static_cast<std::size_t>(stroke) >= strokes) {
    throw std::invalid_argument("stroke " + std::to_string(stroke) + " does not exist, " +
                                std::to_string(strokes) + " were begun");
  }
  for (const PaintLog::Change& change : state().paint.undo(stroke)) state().repaint(change);
  return stroke;
}

ScanCounts FreeSpaceMap::insert(const Scan& scan, const ScanFilter& filter) {
  const MapOptions& options = state().options;
  ScanInsertion insertion{.discretize = options.discretize, .threads = options.threads};
  insertion.integration = options.integration;
  insertion.margins = options.margins;
  const ScanCounts counts =
      insert_scan(state().tree, scan, filter, insertion, state().workspace, &state().evidence);
  const int number = state().scans_inserted++;
  if (counts.origin_invalid) return counts;
  state().seen.see(state().workspace.grid, scan.time, options.threads);
  state().seen_shared = nullptr;
  state().conflicts.inserted(state().tree, state().workspace.grid, scan.time, number);
  if (state().scans) state().scans->add(number, scan.sensor, scan.time, state().workspace.grid);
  return counts;
}

void FreeSpaceMap::note_damaged_recording(std::size_t records) {
  state().tree.set_records_before_damage(records);
}

void FreeSpaceMap::keep_scans(std::size_t budget) { state().scans.emplace(budget); }

const ConflictLog& FreeSpaceMap::conflicts() const { return state().conflicts.log(); }

Provenance FreeSpaceMap::provenance() const {
  Provenance result;
  result.resolution = state().options.resolution;
  for (const PaintedVolume& volume : volumes()) result.volumes.push_back(volume.label);
  result.strokes = state().paint.strokes();
  result.events = state().paint.events();
  result.conflicts = conflicts();
  if (state().scans) result.scans = *state().scans;
  return result;
}

const MapOptions& FreeSpaceMap::options() const { return state().options; }
const std::vector<PaintedVolume>& FreeSpaceMap::volumes() const { return state().paint.volumes(); }

Snapshot FreeSpaceMap::snapshot() const {
  auto tree = std::make_shared<const FusedTree>(state().tree);
  if (!state().seen_shared) state().seen_shared = std::make_shared<const SeenStamps>(state().seen);
  const auto& seen = state().seen_shared;
  state().last = state().last ? Snapshot(std::move(tree), state().paint.volumes(), *state().last, seen)
                              : Snapshot(std::move(tree), state().paint.volumes(), seen);
  return *state().last;
}

}  // namespace clearway
