#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <vector>

#include "mapping/history/provenance.hpp"
#include "mapping/snapshot.hpp"

namespace clearway {

/// A scan by name.
struct ScanName {
  int number = 0;  ///< in order of insertion
  std::string sensor;
  double time = 0.0;  ///< seconds, by the scans' clock
};

/// A stroke that painted a voxel, or erased from it.
struct StrokeName {
  std::string volume, stroke, source;  ///< labels; the last two may be empty
  bool erases = false;
  double first = 0.0, last = 0.0;  ///< seconds, of its spheres that did
};

/// Where what the map says of one voxel comes from.
struct VoxelEvidence {
  Voxel voxel;
  std::optional<double> last_seen;      ///< seconds, as Snapshot::last_seen
  std::vector<std::string> painted_by;  ///< labels of the volumes that contain it

  // With a history.
  bool has_history = false;
  std::vector<ScanName> hits;  ///< the newest `most_named` that hit it, newest first
  std::size_t hit_count = 0, pass_count = 0;
  std::size_t forgotten = 0;        ///< scans that may have touched it, whose record is gone
  std::vector<StrokeName> strokes;  ///< in order of their first sphere

  static constexpr std::size_t most_named = 4;

  /// "hit by 3 scans, the last one scan 12 of 'camera' at 4.2 s; painted by no one"
  std::string sentence() const;
};

/// @param cell_center centre of a voxel at the map's resolution, metres, map frame
/// @param history of this map; null: what the snapshot knows has to do
VoxelEvidence evidence_of(const Snapshot& map, const Provenance* history, const Eigen::Vector3d& cell_center);

}  // namespace clearway
