#pragma once

#include <memory>

#include "mapping/free_space_map.hpp"

namespace clearway {

/// A map that was loaded or painted before, and that scans go on to change: its paint and its evidence stay,
/// and a scan does to its voxels what it does in a FreeSpaceMap, but for voxels beside surfaces that earlier
/// scans contested (METHODS.md): no snapshot holds that, so a look frees such a voxel up to two looks earlier
/// than in the map that went on itself. A hit in a painted voxel is a conflict,
/// blocked under every policy, until misses take it back: then the voxel is painted again. Written by one
/// thread; read through snapshots. The snapshot that it began with does not change.
class ContinuedMap {
 public:
  /// @param options how scans are inserted. Resolution, occupancy threshold and clamping are those of `start`
  /// @throws std::invalid_argument naming one of these options that is out of range.
  ContinuedMap(const Snapshot& start, const MapOptions& options);
  ~ContinuedMap();
  ContinuedMap(ContinuedMap&&) noexcept;
  ContinuedMap& operator=(ContinuedMap&&) noexcept;

  /// Integrates a scan by ray carving, as FreeSpaceMap::insert. Its time is of the clock of the map that it
  /// began with: what that saw later stays seen later.
  ScanCounts insert(const Scan& scan, const ScanFilter& filter = {});

  /// The present state. Takes over the blocked spaces of the snapshot before, and updates them when they are
  /// asked for again.
  const Snapshot& snapshot();

 private:
  struct State;
  State& state() const;
  std::unique_ptr<State> state_;
};

/// A hit probability with which the first hit makes any voxel of `map` occupied, however often it was seen
/// free, and leaves it so when as many `misses` of `miss_probability` follow: at least `least`, at most
/// 0.999999.
double decisive_hit_probability(const Snapshot& map, double least, int misses = 0,
                                double miss_probability = 0.4);

}  // namespace clearway
