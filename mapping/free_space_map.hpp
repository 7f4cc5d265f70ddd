#pragma once

#include <cstddef>
#include <memory>
#include <string>
#include <vector>

#include "mapping/safe_margins.hpp"
#include "mapping/scan.hpp"
#include "mapping/snapshot.hpp"

namespace clearway {

/// How sensors and painting are fused. Probabilities are OctoMap's own by default.
struct MapOptions {
  double resolution = 0.02;           ///< edge of a voxel, metres, in [1e-4, 100]
  double hit_probability = 0.7;       ///< of a voxel in which a ray ends
  double miss_probability = 0.4;      ///< of a voxel that a ray passes
  double min_probability = 0.1192;    ///< clamping, as OctoMap
  double max_probability = 0.971;     ///< clamping, as OctoMap
  double occupied_probability = 0.5;  ///< at or over it a voxel is occupied
  bool discretize = false;            ///< one ray per end voxel and scan (OctoMap's "discretized" insertion)
  int threads = 1;                    ///< for inserting scans, in [1, 64]; results do not depend on it
  Integration integration = Integration::compatible;  ///< what a scan frees
  SafeMargins margins{};                              ///< of safe integration
};

/// What one painted ball did to the voxels.
struct PaintCounts {
  std::size_t painted = 0;    ///< voxels wholly inside the ball
  std::size_t newly = 0;      ///< of these, voxels that this volume had not painted before
  std::size_t conflicts = 0;  ///< of these, voxels that sensors call occupied
};

/// The one map: fuses painted balls and scans into one OctoMap tree. Written by one thread; read through
/// snapshots. Painting never changes a sensor's log-odds; sensing never erases paint: a voxel that is both
/// painted and occupied is a conflict, blocked and counted.
class FreeSpaceMap {
 public:
  /// @throws std::invalid_argument naming the option that is out of range.
  explicit FreeSpaceMap(const MapOptions& options = {});
  ~FreeSpaceMap();
  FreeSpaceMap(FreeSpaceMap&&) noexcept;
  FreeSpaceMap& operator=(FreeSpaceMap&&) noexcept;

  /// Adds an empty painted volume and returns its index (bit in Voxel::volumes).
  /// @throws std::invalid_argument when the label exists already or 15 volumes exist.
  int add_volume(const std::string& label, const std::vector<std::string>& critical_parts);

  /// Paints the voxels that lie wholly inside `ball` and keeps the ball itself (Chong et al. 2008, eq. 2).
  /// @throws std::invalid_argument for an unknown volume, a non-finite ball or a radius <= 0.
  PaintCounts paint(int volume, const Sphere& ball, double time = 0.0);

  /// Integrates a scan by ray carving (OctoMap's traversal); in `safe` integration less is freed.
  ScanCounts insert(const Scan& scan, const ScanFilter& filter = {});

  const MapOptions& options() const;
  const std::vector<PaintedVolume>& volumes() const;

  /// An immutable copy of the present state.
  Snapshot snapshot() const;

 private:
  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace clearway
